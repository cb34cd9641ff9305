// Finds the file of a mesh that a URDF file names.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace vp::detail {

// Returns the path, or nullopt. urdf_path: the URDF file; may be empty. UrdfWorldOptions::folders
// documents the search order.
std::optional<std::string> find_mesh(const std::string& name, const std::string& urdf_path,
                                     std::span<const std::string> folders);

}  // namespace vp::detail
