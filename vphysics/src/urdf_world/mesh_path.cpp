#include "urdf_world/mesh_path.h"

#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

namespace vp::detail {
namespace {

namespace fs = std::filesystem;

// Removes the prefix, if the name starts with it.
bool drop_prefix(std::string_view& name, std::string_view prefix) {
  if (name.substr(0, prefix.size()) != prefix) return false;
  name.remove_prefix(prefix.size());
  return true;
}

// The file's folder and its parents, innermost first. A relative path is resolved up to the root.
std::vector<fs::path> folders_around(const std::string& file) {
  std::vector<fs::path> out;
  if (file.empty()) return out;
  std::error_code failed;
  const fs::path full = fs::absolute(file, failed);
  if (failed) return out;
  for (fs::path folder = full.parent_path(); out.empty() || out.back() != folder;
       folder = folder.parent_path()) {
    out.push_back(folder);
  }
  return out;
}

std::string last_name(const fs::path& folder) {
  return (folder.has_filename() ? folder : folder.parent_path()).filename().string();
}

}  // namespace

std::optional<std::string> find_mesh(const std::string& name, const std::string& urdf_path,
                                     std::span<const std::string> folders) {
  const auto is_file = [](const fs::path& path) {
    std::error_code failed;
    return fs::is_regular_file(path, failed);
  };
  std::vector<fs::path> tried;
  std::string_view rest = name;
  const std::vector<fs::path> around = folders_around(urdf_path);
  if (drop_prefix(rest, "package://") || drop_prefix(rest, "model://")) {
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const fs::path package(rest.substr(0, slash));
    const fs::path inside(rest.substr(std::min(slash + 1, rest.size())));
    const auto in = [&](const fs::path& folder) {
      tried.push_back(folder / package / inside);
      if (last_name(folder) == package) tried.push_back(folder / inside);
    };
    for (const std::string& folder : folders) in(folder);
    for (const fs::path& folder : around) in(folder);
    // A package whose folder has another name.
    for (const std::string& folder : folders) tried.push_back(fs::path(folder) / inside);
    for (const fs::path& folder : around) tried.push_back(folder / inside);
  } else {
    drop_prefix(rest, "file://");
    const fs::path path(rest);
    if (path.is_absolute()) {
      tried.push_back(path);
    } else {
      if (!around.empty()) tried.push_back(around.front() / path);
      for (const std::string& folder : folders) tried.push_back(fs::path(folder) / path);
    }
  }
  for (const fs::path& path : tried) {
    if (is_file(path)) return path.string();
  }
  return std::nullopt;
}

}  // namespace vp::detail
