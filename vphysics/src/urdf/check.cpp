#include "urdf/check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <string_view>

namespace vp::detail {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

constexpr std::string_view kBlank = " \t\r\n";

std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 60;
  std::string out(1, '"');
  out += text.substr(0, kShown);
  return out += text.size() > kShown ? "...\"" : "\"";
}
std::string tag(const XMLElement& element) {
  std::string out(1, '<');
  out += element.Name();
  return out += '>';
}

// Parses one finite number and removes it from the front. Unlike strtod, it ignores the locale and
// accepts no hexadecimal numbers.
std::optional<double> take_number(std::string_view& text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (!text.empty() && kBlank.find(text[0]) == std::string_view::npos) return std::nullopt;
  return value;
}

std::string written(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

// Walks the document. Stops at the first fault.
class Checker {
 public:
  explicit Checker(std::vector<std::string>& notes) : notes_(notes) {}

  Expected<UrdfLines> check(XMLElement& robot) {
    if (std::strcmp(robot.Name(), "robot") != 0) {
      fail(robot, "the root element is " + tag(robot) + ", not <robot>");
    } else {
      this->robot(robot);
    }
    if (fault_) return tl::make_unexpected(*std::move(fault_));
    for (const auto& [name, seen] : left_out_) {
      notes_.push_back(urdf_note(
          seen.line, name + " left out" +
                         (seen.count > 1 ? ", " + std::to_string(seen.count) + " in all" : "")));
    }
    return std::move(lines_);
  }

 private:
  struct Seen {
    int line, count;
  };
  enum class Need { optional, required };

  void fail(int line, const std::string& what) {
    if (!fault_) fault_ = urdf_error(line, what);
  }
  void fail(const XMLElement& at, const std::string& what) { fail(at.GetLineNum(), what); }
  void leave_out(const std::string& what, int line) {
    ++left_out_.try_emplace(what, Seen{line, 0}).first->second.count;
  }
  void note(const XMLElement& at, const std::string& what) {
    notes_.push_back(urdf_note(at.GetLineNum(), what));
  }

  void robot(XMLElement& robot) {
    attributes(robot, {"name", "version"});
    if (const char* name = robot.Attribute("name"); !name || !*name) {
      note(robot, "the robot has no name");
      robot.SetAttribute("name", "");  // urdfdom requires the attribute
    } else {
      (void)name_of(robot);
    }
    if (const char* version = robot.Attribute("version");
        version && std::string_view(version) != "1.0") {
      fail(robot, "version " + quoted(version) + " of URDF is not known, only 1.0");
    }
    robot.DeleteAttribute("version");
    children(robot, {"link", "joint"});
    for (XMLElement* e = robot.FirstChildElement(); e && !fault_; e = e->NextSiblingElement()) {
      std::strcmp(e->Name(), "link") == 0 ? link(*e) : joint(*e);
    }
    if (lines_.links.empty()) fail(robot, "the robot has no link");
  }

  void link(XMLElement& link) {
    attributes(link, {"name"});
    const std::string name = name_of(link);
    if (const auto [at, fresh] = lines_.links.try_emplace(name, link.GetLineNum()); !fresh) {
      fail(link, "the link " + quoted(name) + " stands on line " + std::to_string(at->second) +
                     " already");
    }
    collisions(link, name);
    children(link, {"inertial"});
    XMLElement* inertial = once(link, "inertial", Need::optional);
    if (!inertial) return;
    lines_.inertials[name] = inertial->GetLineNum();
    attributes(*inertial, {});
    children(*inertial, {"origin", "mass", "inertia"});
    origin(*inertial);
    if (XMLElement* mass = once(*inertial, "mass", Need::required)) {
      attributes(*mass, {"value"});
      if (number(*mass, "value", Need::required) < 0.0) fail(*mass, "a mass must not be negative");
    }
    if (XMLElement* inertia = once(*inertial, "inertia", Need::required)) {
      attributes(*inertia, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
      for (const char* moment : {"ixx", "iyy", "izz"}) number(*inertia, moment, Need::required);
      for (const char* product : {"ixy", "ixz", "iyz"}) {
        number(*inertia, product, Need::optional);
        if (inertia->Attribute(product)) continue;
        note(*inertia, std::string(product) + " is not given, and taken as zero");
        inertia->SetAttribute(product, "0");
      }
    }
  }

  // Removes them from the document: urdfdom would reject the robot for a fault in one of them.
  void collisions(XMLElement& link, const std::string& name) {
    for (XMLElement* e = link.FirstChildElement("collision"); e;) {
      XMLElement* const next = e->NextSiblingElement("collision");
      if (auto read = collision(*e)) lines_.collisions[name].push_back(*std::move(read));
      link.DeleteChild(e);
      e = next;
    }
  }

  std::optional<UrdfCollision> collision(XMLElement& element) {
    using Kind = UrdfCollision::Kind;
    constexpr std::array<double, 3> kOrigin{};
    UrdfCollision out;
    out.line = element.GetLineNum();
    out.name = text(element, "name", Need::optional);
    if (const XMLElement* origin = element.FirstChildElement("origin")) {
      const auto xyz = numbers_or<3>(*origin, "xyz", kOrigin);
      const auto rpy = numbers_or<3>(*origin, "rpy", kOrigin);
      if (!xyz || !rpy) return std::nullopt;
      const auto about = [&](const Vec3& axis, std::size_t k) { return Exp((*rpy)[k] * axis); };
      out.T_link_shape = SE3(about({0, 0, 1}, 2) * about({0, 1, 0}, 1) * about({1, 0, 0}, 0),
                             {(*xyz)[0], (*xyz)[1], (*xyz)[2]});
    }
    const XMLElement* geometry = element.FirstChildElement("geometry");
    const XMLElement* shape = geometry ? geometry->FirstChildElement() : nullptr;
    if (!shape) {
      note(element, "a <collision> without geometry is left out");
      return std::nullopt;
    }
    const auto length = [&](const char* what, double& value) {
      const auto read = numbers_or<1>(*shape, what, std::nullopt);
      if (read) value = (*read)[0];
      return read.has_value();
    };
    const std::string_view kind = shape->Name();
    bool good = false;
    if (kind == "box" || kind == "mesh") {
      const bool box = kind == "box";
      const auto size = box ? numbers_or<3>(*shape, "size", std::nullopt) : scale_of(*shape);
      if (size) out.size = {(*size)[0], (*size)[1], (*size)[2]};
      if (!box) out.mesh = text_or_empty(*shape, "filename");
      out.kind = box ? Kind::box : Kind::mesh;
      good = size.has_value();
    } else if (kind == "sphere") {
      out.kind = Kind::sphere;
      good = length("radius", out.radius);
    } else if (kind == "cylinder" || kind == "capsule") {
      out.kind = kind == "capsule" ? Kind::capsule : Kind::cylinder;
      good = length("radius", out.radius) && length("length", out.length);
    } else {
      note(*shape, "a <collision> is left out: " + tag(*shape) +
                       " is not known; it is box, sphere, cylinder, capsule or mesh");
    }
    return good ? std::optional(std::move(out)) : std::nullopt;
  }

  static std::string text_or_empty(const XMLElement& element, const char* attribute) {
    const char* value = element.Attribute(attribute);
    return value ? value : "";
  }
  // A single factor scales all three axes.
  std::optional<std::array<double, 3>> scale_of(const XMLElement& mesh) {
    if (const char* scale = mesh.Attribute("scale")) {
      if (const auto one = all_numbers<1>(scale))
        return std::array{(*one)[0], (*one)[0], (*one)[0]};
    }
    return numbers_or<3>(mesh, "scale", std::array{1.0, 1.0, 1.0});
  }
  // For a collision: the numbers of an attribute, or the default if it is missing. Returns nullopt,
  // with a note, if they are invalid, or missing without a default.
  template <std::size_t N>
  std::optional<std::array<double, N>> numbers_or(const XMLElement& element, const char* attribute,
                                                  std::optional<std::array<double, N>> otherwise) {
    const char* given = element.Attribute(attribute);
    if (!given && otherwise) return otherwise;
    const auto read = all_numbers<N>(given ? given : "");
    if (!read) {
      note(element, "a <collision> is left out: " + std::string(attribute) + "=" +
                        quoted(given ? given : "") + " of " + tag(element) +
                        (N == 1 ? " is no finite number"
                                : " is not " + std::to_string(N) + " finite numbers"));
    }
    return read;
  }
  template <std::size_t N>
  static std::optional<std::array<double, N>> all_numbers(std::string_view text) {
    std::array<double, N> values{};
    for (double& value : values) {
      text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
      const std::optional<double> number = take_number(text);
      if (!number) return std::nullopt;
      value = *number;
    }
    if (text.find_first_not_of(kBlank) != std::string_view::npos) return std::nullopt;
    return values;
  }

  void joint(XMLElement& joint) {
    attributes(joint, {"name", "type"});
    const std::string name = name_of(joint);
    const std::string type = text(joint, "type", Need::required);
    bool known = false;
    for (const char* kind :
         {"fixed", "revolute", "continuous", "prismatic", "floating", "planar"}) {
      known = known || type == kind;
    }
    if (!known) {
      fail(joint, "the type " + quoted(type) + " of joint " + quoted(name) +
                      " is not known; it is fixed, revolute, continuous, prismatic, floating or "
                      "planar");
    }
    children(joint, {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"});
    origin(joint);
    UrdfLines::Joint place{};
    place.line = joint.GetLineNum();
    place.order = static_cast<int>(lines_.joints.size());
    end(joint, "parent", place.parent, place.parent_line);
    end(joint, "child", place.child, place.child_line);
    axis(joint, type != "fixed" && type != "floating");
    limit(joint, type == "revolute" || type == "prismatic");
    dynamics(joint);
    mimic(joint, place);
    if (const auto [at, fresh] = lines_.joints.try_emplace(name, std::move(place)); !fresh) {
      fail(joint, "the joint " + quoted(name) + " stands on line " +
                      std::to_string(at->second.line) + " already");
    }
  }

  void origin(XMLElement& parent) {
    XMLElement* origin = once(parent, "origin", Need::optional);
    if (!origin) return;
    attributes(*origin, {"xyz", "rpy"});
    numbers<3>(*origin, "xyz", Need::optional);
    numbers<3>(*origin, "rpy", Need::optional);
  }

  void end(XMLElement& joint, const char* which, std::string& name, int& line) {
    XMLElement* end = joint.FirstChildElement(which);
    if (!end) return fail(joint, tag(joint) + " needs a <" + which + ">");
    if (const XMLElement* second = end->NextSiblingElement(which)) {
      return fail(*second, tag(joint) + " has a second <" + which + ">");
    }
    attributes(*end, {"link"});
    name = text(*end, "link", Need::required);
    line = end->GetLineNum();
  }

  // needed: joints of this type have an axis.
  void axis(XMLElement& joint, bool needed) {
    XMLElement* axis = once(joint, "axis", Need::optional);
    if (!axis) return;
    if (!needed) {
      joint.DeleteChild(axis);
      return;
    }
    attributes(*axis, {"xyz"});
    if (!axis->Attribute("xyz")) {
      note(*axis, "the axis has no number, and is taken as x");
      joint.DeleteChild(axis);
      return;
    }
    const auto [x, y, z] = numbers<3>(*axis, "xyz", Need::required);
    const double length = std::hypot(x, y, z);
    if (!(length > 1e-100 && length < 1e100)) fail(*axis, "the axis has no length");
  }

  // bounded: joints of this type have limits.
  void limit(XMLElement& joint, bool bounded) {
    XMLElement* limit = once(joint, "limit", Need::optional);
    if (!limit) {
      if (!bounded) return;
      note(joint, "the joint has no <limit>, and moves without one");
      limit = joint.InsertNewChildElement("limit");
      limit->SetAttribute("lower", written(-kUrdfUnbounded).c_str());
      for (const char* bound : {"upper", "effort", "velocity"}) {
        limit->SetAttribute(bound, written(kUrdfUnbounded).c_str());
      }
    }
    attributes(*limit, {"lower", "upper", "effort", "velocity"});
    const double lower = number(*limit, "lower", Need::optional);
    const double upper = number(*limit, "upper", Need::optional);
    if (lower > upper) {
      note(*limit,
           "the lower limit is above the upper one (either is 0 if it is not given): the two "
           "are exchanged");
      limit->SetAttribute("lower", written(upper).c_str());
      limit->SetAttribute("upper", written(lower).c_str());
    }
    for (const char* bound : {"effort", "velocity"}) {
      const double max_value = number(*limit, bound, Need::optional);
      if (limit->Attribute(bound) && max_value >= 0.0) continue;
      note(*limit, std::string(bound) + (max_value < 0.0 ? " is negative" : " is not given") +
                       ", and taken as unlimited");
      limit->SetAttribute(bound, written(kUrdfUnbounded).c_str());
    }
  }

  void dynamics(XMLElement& joint) {
    XMLElement* dynamics = once(joint, "dynamics", Need::optional);
    if (!dynamics) return;
    attributes(*dynamics, {"damping", "friction"});
    for (const char* what : {"damping", "friction"}) {
      if (number(*dynamics, what, Need::optional) >= 0.0) continue;
      note(*dynamics, std::string(what) + " is negative, and taken as zero");
      dynamics->SetAttribute(what, "0");
    }
    // urdfdom rejects an empty <dynamics>.
    if (!dynamics->FirstAttribute()) joint.DeleteChild(dynamics);
  }

  void mimic(XMLElement& joint, UrdfLines::Joint& place) {
    XMLElement* mimic = once(joint, "mimic", Need::optional);
    if (!mimic) return;
    attributes(*mimic, {"joint", "multiplier", "offset"});
    place.mimics = text(*mimic, "joint", Need::required);
    place.mimic_line = mimic->GetLineNum();
    number(*mimic, "multiplier", Need::optional);
    number(*mimic, "offset", Need::optional);
  }

  // Keeps only the known attributes.
  void attributes(XMLElement& element, std::initializer_list<const char*> known) {
    for (const tinyxml2::XMLAttribute* a = element.FirstAttribute(); a && !fault_;) {
      const std::string name = a->Name();
      const int line = a->GetLineNum();
      a = a->Next();
      bool is_known = false;
      for (const char* each : known) is_known = is_known || name == each;
      if (is_known) continue;
      leave_out("attribute " + quoted(name) + " of " + tag(element), line);
      element.DeleteAttribute(name.c_str());
    }
  }

  // Keeps only the known elements.
  void children(XMLElement& parent, std::initializer_list<const char*> known) {
    for (XMLNode* node = parent.FirstChild(); node && !fault_;) {
      XMLNode* const next = node->NextSibling();
      const XMLElement* element = node->ToElement();
      bool is_known = false;
      for (const char* each : known) {
        is_known = is_known || (element && std::strcmp(element->Name(), each) == 0);
      }
      if (!is_known) {
        if (element) leave_out(tag(*element) + " of " + tag(parent), element->GetLineNum());
        parent.DeleteChild(node);
      }
      node = next;
    }
  }

  XMLElement* once(XMLElement& parent, const char* name, Need need) {
    XMLElement* found = parent.FirstChildElement(name);
    if (!found && need == Need::required) {
      fail(parent, tag(parent) + " needs a <" + name + ">");
    }
    while (XMLElement* second = found ? found->NextSiblingElement(name) : nullptr) {
      leave_out("second " + tag(*second) + " of " + tag(parent), second->GetLineNum());
      parent.DeleteChild(second);
    }
    return fault_ ? nullptr : found;
  }

  std::string text(XMLElement& element, const char* attribute, Need need) {
    const char* value = element.Attribute(attribute);
    if (!value && need == Need::required) {
      fail(element, tag(element) + " needs the attribute \"" + attribute + "\"");
    }
    return value ? value : "";
  }

  std::string name_of(XMLElement& element) {
    std::string name = text(element, "name", Need::required);
    if (name.empty()) fail(element, "the name of " + tag(element) + " is empty");
    for (const char c : name) {
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
        fail(element, "the name of " + tag(element) + " has a control character");
      }
    }
    return name;
  }

  double number(XMLElement& element, const char* attribute, Need need) {
    return numbers<1>(element, attribute, need)[0];
  }
  // The numbers of an attribute, or zeros if it is missing. Rewrites them in the document.
  template <std::size_t N>
  std::array<double, N> numbers(XMLElement& element, const char* attribute, Need need) {
    std::array<double, N> values{};
    const std::string given = text(element, attribute, need);
    if (fault_ || !element.Attribute(attribute)) return values;
    std::string_view rest = given;
    std::string anew;
    std::size_t count = 0;
    for (;; ++count) {
      rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
      if (rest.empty() || count == N) break;
      const std::optional<double> value = take_number(rest);
      if (!value) break;
      values[count] = *value;
      if (count) anew += ' ';
      anew += written(*value);
    }
    if (count != N || !rest.empty()) {
      fail(element, std::string(attribute) + "=" + quoted(given) + " of " + tag(element) +
                        (N == 1 ? " is no finite number"
                                : " is not " + std::to_string(N) + " finite numbers"));
    }
    element.SetAttribute(attribute, anew.c_str());
    return values;
  }

  std::vector<std::string>& notes_;
  UrdfLines lines_;
  std::map<std::string, Seen> left_out_;
  std::optional<Error> fault_;
};

}  // namespace

std::string urdf_note(int line, const std::string& what) {
  return "line " + std::to_string(line) + ": " + what;
}
Error urdf_error(int line, const std::string& what) {
  return {Errc::bad_data, urdf_note(line, what)};
}

Expected<UrdfLines> check_urdf(XMLElement& robot, std::vector<std::string>& notes) {
  return Checker(notes).check(robot);
}

void ignore_mimic(const std::string& name, UrdfLines::Joint& joint, const std::string& why,
                  std::vector<std::string>& notes) {
  notes.push_back(
      urdf_note(joint.mimic_line, "what joint " + quoted(name) + " mimics is left out: " + why));
  joint.mimics.clear();
  joint.mimic_line = 0;
}

Expected<void> check_tree(UrdfLines& lines, std::vector<std::string>& notes) {
  const auto fault = [](int line, const std::string& what) {
    return tl::make_unexpected(urdf_error(line, what));
  };
  std::map<std::string, const UrdfLines::Joint*> above;  // the parent joint of each link
  for (auto& [name, joint] : lines.joints) {
    if (!lines.links.contains(joint.parent)) {
      return fault(joint.parent_line, "joint " + quoted(name) + " has the parent link " +
                                          quoted(joint.parent) + ", and there is none");
    }
    if (!lines.links.contains(joint.child)) {
      return fault(joint.child_line, "joint " + quoted(name) + " has the child link " +
                                         quoted(joint.child) + ", and there is none");
    }
    if (joint.mimic_line && !lines.joints.contains(joint.mimics)) {
      ignore_mimic(name, joint, "there is no joint " + quoted(joint.mimics), notes);
    }
    const auto [other, fresh] = above.try_emplace(joint.child, &joint);
    if (!fresh) {
      const auto [first, second] = std::minmax(other->second->line, joint.line);
      return fault(second, "the link " + quoted(joint.child) +
                               " has a parent already, by the joint on line " +
                               std::to_string(first) + "; a loop is closed by a constraint");
    }
  }
  for (auto& [name, joint] : lines.joints) {
    const UrdfLines::Joint* at = &joint;
    for (std::size_t steps = 0; at->mimic_line; ++steps) {
      if (steps > lines.joints.size()) {
        ignore_mimic(name, joint, "it leads in a circle", notes);
        break;
      }
      at = &lines.joints.at(at->mimics);
    }
  }
  const std::string* root = nullptr;
  for (const auto& [name, line] : lines.links) {
    if (above.contains(name)) continue;
    if (root) {
      const auto [first, second] = std::minmax(lines.links.at(*root), line);
      return fault(second, "two links have no parent, " + quoted(*root) + " and " + quoted(name) +
                               " (lines " + std::to_string(first) + " and " +
                               std::to_string(second) + "); join them by a joint");
    }
    root = &name;
  }
  // Walks from each link towards the root, until a link that an earlier walk reached, or one of
  // this walk: a cycle.
  std::map<std::string, int> reached;  // number of the walk
  int walk = 0;
  for (const auto& [start, line] : lines.links) {
    ++walk;
    for (const std::string* at = &start; !root || *at != *root;) {
      const auto [seen, fresh] = reached.try_emplace(*at, walk);
      const UrdfLines::Joint& joint = *above.at(*at);
      if (!fresh && seen->second == walk) {
        return fault(joint.line, "the joints lead in a circle through the link " + quoted(*at));
      }
      if (!fresh) break;
      at = &joint.parent;
    }
  }
  return {};
}

}  // namespace vp::detail
