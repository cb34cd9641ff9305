// URDF in three steps: tinyxml2 reads the text, which it bounds in depth and knows the lines of;
// check.cpp finds what is wrong; build.cpp has urdfdom build what is left.
#include "vphysics/multibody/urdf.h"

#include <tinyxml2.h>

#include <algorithm>
#include <exception>
#include <fstream>

#include "urdf/build.h"

namespace vp {
namespace {

constexpr std::size_t kLargest = std::size_t{16} << 20;  // a humanoid's text is 0.2 MiB

tl::unexpected<Error> too_large() {
  return tl::make_unexpected(
      Error{Errc::unsupported, "more than 16 MiB of text; no robot needs them"});
}

std::string reason(const tinyxml2::XMLDocument& document) {
  switch (document.ErrorID()) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "there is no element";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is closed that was not the last opened, or is not closed at all";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements are nested more than 100 deep";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is not written as name=\"value\", or stands twice";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "an element is not well formed";
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      return "a comment does not end";
    case tinyxml2::XML_ERROR_PARSING:
      return "not well-formed XML; is an element not closed?";
    default:
      return std::string("not well-formed XML (") + document.ErrorName() + ")";
  }
}

// Where an element has more attributes than any needs, or npos: tinyxml2 compares each of them with
// each, and a stranger's million would take hours. As far as tinyxml2 reads without an error, this
// finds the same elements.
std::size_t overfull_element(std::string_view text) {
  constexpr int kMost = 200;
  const auto after = [&](std::string_view end, std::size_t from) {
    const std::size_t at = text.find(end, from);
    return at == std::string_view::npos ? text.size() : at + end.size();
  };
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    if (text.compare(at, 4, "<!--") == 0) {
      at = after("-->", at + 4);
    } else if (text.compare(at, 9, "<![CDATA[") == 0) {
      at = after("]]>", at + 9);
    } else if (text.compare(at, 2, "<?") == 0) {
      at = after("?>", at + 2);
    } else if (text.compare(at, 2, "<!") == 0) {
      at = after(">", at + 2);
    } else {
      int attributes = 0;
      while (at < text.size() && text[at] != '>') {
        if (text[at] == '=' && ++attributes > kMost) return at;
        const bool quote = text[at] == '"' || text[at] == '\'';
        at = quote ? after(text.substr(at, 1), at + 1) : at + 1;
      }
    }
  }
  return std::string_view::npos;
}

Expected<UrdfModel> parse(std::string_view text, const UrdfOptions& options) {
  if (text.size() > kLargest) return too_large();
  // Written by programs in C: the end of their string with it.
  while (!text.empty() && text.back() == '\0') text.remove_suffix(1);
  const auto fault_at = [&](std::size_t at, const char* what) {
    const auto lines = std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
    return tl::make_unexpected(detail::urdf_error(1 + static_cast<int>(lines), what));
  };
  if (const std::size_t at = text.find('\0'); at != std::string_view::npos) {
    return fault_at(at, "a zero byte, which no XML text has");
  }
  if (const std::size_t at = overfull_element(text); at != std::string_view::npos) {
    return fault_at(at, "an element with more than 200 attributes");
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return tl::make_unexpected(
        detail::urdf_error(std::max(1, document.ErrorLineNum()), reason(document)));
  }
  tinyxml2::XMLElement* robot = document.RootElement();
  if (!robot) return tl::make_unexpected(detail::urdf_error(1, "there is no element"));
  std::vector<std::string> notes;
  auto lines = detail::check_urdf(*robot, notes);
  if (!lines) return tl::make_unexpected(lines.error());
  if (auto good = detail::check_tree(*lines, notes); !good)
    return tl::make_unexpected(good.error());

  tinyxml2::XMLPrinter cleaned;
  robot->Accept(&cleaned);
  return detail::build_urdf(cleaned.CStr(), *lines, options, std::move(notes));
}

}  // namespace

const UrdfJoint* UrdfModel::find_joint(std::string_view joint_name) const {
  for (const UrdfJoint& joint : joints) {
    if (joint.name == joint_name) return &joint;
  }
  return nullptr;
}

Expected<UrdfModel> parse_urdf(std::string_view text, const UrdfOptions& options) {
  LinkSpec root;
  root.T_parent_joint = options.T_world_root;
  if (!ModelBuilder().add(std::move(root))) {
    return tl::make_unexpected(
        Error{Errc::invalid_argument, "T_world_root must be finite and its rotation a rotation"});
  }
  try {  // urdfdom and the standard library throw
    return parse(text, options);
  } catch (const std::exception& thrown) {
    return tl::make_unexpected(
        detail::urdf_error(1, std::string("it cannot be built: ") + thrown.what()));
  } catch (...) {
    return tl::make_unexpected(detail::urdf_error(1, "it cannot be built"));
  }
}

Expected<UrdfModel> load_urdf(const std::string& path, const UrdfOptions& options) {
  std::string text;
  {
    std::ifstream file(path, std::ios::binary);
    constexpr std::size_t kPiece = 65536;
    while (file && text.size() <= kLargest) {
      const std::size_t before = text.size();
      text.resize(before + kPiece);
      file.read(text.data() + before, kPiece);
      text.resize(before + static_cast<std::size_t>(file.gcount()));
    }
    if (!file.eof() && text.size() <= kLargest) {
      return tl::make_unexpected(
          Error{Errc::bad_data, path + ": it cannot be read; is it there, and a file?"});
    }
  }
  auto model = parse_urdf(text, options);
  if (!model) model.error().message.insert(0, path + ": ");
  return model;
}

}  // namespace vp
