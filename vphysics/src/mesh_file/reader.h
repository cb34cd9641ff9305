// Shared by the readers of mesh files: a mesh builder, and text as words and numbers.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "vphysics/mesh_file.h"

namespace vp::detail {

// Builds a mesh, with a limit of triangles and of three times as many vertices.
class MeshBuilder {
 public:
  explicit MeshBuilder(std::size_t max_triangles) : max_triangles_(max_triangles) {}

  // Adds a vertex, finite or not, and returns its index.
  std::uint32_t vertex(const Vec3& v) {
    full_ = full_ || mesh.vertices.size() >= 3 * max_triangles_;
    mesh.vertices.push_back(v);
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  }
  // Adds a polygon as a fan of triangles from its first corner. Checks its indices.
  void polygon(std::span<const std::int64_t> corners);
  // Starts another object.
  void begin_object();
  bool full() const { return full_; }
  // Removes vertices that are not finite; their triangles were never added. Returns the mesh.
  Expected<MeshFile> finish(const char* format);

  MeshFile mesh;

 private:
  bool good(std::int64_t index) const;

  std::size_t max_triangles_;
  bool full_ = false;
};

inline constexpr std::string_view kSpace = " \t\r\n\f\v";

// Returns the next word and removes it from the front of the text; empty at the end.
inline std::string_view take_token(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  const std::string_view token = text.substr(0, text.find_first_of(kSpace));
  text.remove_prefix(token.size());
  return token;
}

// Unlike strtod, it ignores the locale. NaN if the word is not a number.
inline double to_number(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  double value = 0.0;
  const auto [end, failed] = std::from_chars(token.data(), token.data() + token.size(), value);
  return failed == std::errc() && end == token.data() + token.size() ? value : std::nan("");
}
inline Vec3 take_vec3(std::string_view& text) {
  const double x = to_number(take_token(text));
  const double y = to_number(take_token(text));
  const double z = to_number(take_token(text));
  return {x, y, z};
}

void read_stl(std::string_view bytes, MeshBuilder& builder, std::string& fault);
void read_obj(std::string_view text, MeshBuilder& builder);
void read_collada(std::string_view text, MeshBuilder& builder, std::string& fault);

}  // namespace vp::detail
