// Reads URDF in three steps: tinyxml2 parses the text, with bounded depth and line numbers;
// check.cpp finds and repairs faults; build.cpp builds the model with urdfdom.
#include "vphysics/multibody/urdf.h"

#include <exception>
#include <utility>

#include "files/read_file.h"
#include "files/xml.h"
#include "urdf/build.h"

namespace vp {
namespace {

constexpr std::size_t kLargest = std::size_t{16} << 20;  // a humanoid's text is 0.2 MiB

tl::unexpected<Error> too_large() {
  return tl::make_unexpected(
      Error{Errc::unsupported, "more than 16 MiB of text; no robot needs them"});
}

Expected<UrdfModel> parse(std::string_view text, const UrdfOptions& options) {
  if (text.size() > kLargest) return too_large();
  tinyxml2::XMLDocument document;
  if (auto read = detail::parse_xml(text, document); !read) {
    return tl::make_unexpected(std::move(read.error()));
  }
  tinyxml2::XMLElement* robot = document.RootElement();
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
  const auto text = detail::read_file(path, kLargest);
  if (!text) return tl::make_unexpected(text.error());
  auto model = parse_urdf(*text, options);
  if (!model) model.error().message.insert(0, path + ": ");
  return model;
}

}  // namespace vp
