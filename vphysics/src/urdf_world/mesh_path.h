// Where a mesh that a URDF file names is.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace vp::detail {

// The file, or none. urdf_path: the file that names it, may be empty. UrdfWorldOptions::folders
// says where is looked.
std::optional<std::string> find_mesh(const std::string& name, const std::string& urdf_path,
                                     std::span<const std::string> folders);

}  // namespace vp::detail
