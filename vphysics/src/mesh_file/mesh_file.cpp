#include "vphysics/mesh_file.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "files/read_file.h"
#include "mesh_file/reader.h"

namespace vp {

namespace detail {

bool MeshBuilder::good(std::int64_t index) const {
  if (index < 0 || static_cast<std::size_t>(index) >= mesh.vertices.size()) return false;
  const Vec3& v = mesh.vertices[static_cast<std::size_t>(index)];
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void MeshBuilder::polygon(std::span<const std::int64_t> corners) {
  if (corners.size() < 3 ||
      !std::all_of(corners.begin(), corners.end(), [&](std::int64_t i) { return good(i); })) {
    ++mesh.left_out;
    return;
  }
  const auto corner = [&](std::size_t k) { return static_cast<std::uint32_t>(corners[k]); };
  for (std::size_t k = 2; k < corners.size(); ++k) {
    full_ = full_ || mesh.triangles.size() >= max_triangles_;
    if (full_) return;
    mesh.triangles.push_back({corner(0), corner(k - 1), corner(k)});
  }
}

void MeshBuilder::begin_object() {
  auto& objects = mesh.objects;
  if (objects.empty() || objects.back() != mesh.triangles.size()) {
    objects.push_back(mesh.triangles.size());
  }
}

Expected<MeshFile> MeshBuilder::finish(const char* format) {
  if (full_) {
    return tl::make_unexpected(Error{
        Errc::unsupported, "more than " + std::to_string(max_triangles_) +
                               " triangles, or three times as many vertices; simplify the mesh, or "
                               "allow more by MeshLimits"});
  }
  // Triangles refer only to finite vertices. Removes the other vertices and renumbers.
  std::vector<std::uint32_t> number(mesh.vertices.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    number[i] = static_cast<std::uint32_t>(count);
    if (good(static_cast<std::int64_t>(i))) mesh.vertices[count++] = mesh.vertices[i];
  }
  mesh.vertices.resize(count);
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner = number[corner];
  }
  if (count == 0) {
    return tl::make_unexpected(Error{
        Errc::bad_data, std::string("no vertex that ") + format + " has; is it such a file?"});
  }
  while (!mesh.objects.empty() && mesh.objects.back() == mesh.triangles.size()) {
    mesh.objects.pop_back();
  }
  if (!mesh.triangles.empty() && (mesh.objects.empty() || mesh.objects.front() != 0)) {
    mesh.objects.insert(mesh.objects.begin(), 0);
  }
  return std::move(mesh);
}

}  // namespace detail

namespace {

bool ends_with(std::string_view path, std::string_view end) {
  if (path.size() < end.size()) return false;
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(end.begin(), end.end(), path.end() - static_cast<long>(end.size()),
                    [&](char a, char b) { return a == lower(b); });
}

Expected<MeshFile> parse(std::string_view bytes, MeshFormat format, std::size_t max_triangles) {
  detail::MeshBuilder builder(max_triangles);
  std::string fault;
  switch (format) {
    case MeshFormat::stl:
      detail::read_stl(bytes, builder, fault);
      break;
    case MeshFormat::obj:
      detail::read_obj(bytes, builder);
      break;
    case MeshFormat::collada:
      detail::read_collada(bytes, builder, fault);
      break;
  }
  if (!fault.empty()) return tl::make_unexpected(Error{Errc::bad_data, std::move(fault)});
  return builder.finish(format == MeshFormat::stl   ? "STL"
                        : format == MeshFormat::obj ? "OBJ"
                                                    : "COLLADA");
}

}  // namespace

std::optional<MeshFormat> mesh_format(std::string_view path) {
  if (ends_with(path, ".stl")) return MeshFormat::stl;
  if (ends_with(path, ".obj")) return MeshFormat::obj;
  if (ends_with(path, ".dae")) return MeshFormat::collada;
  return std::nullopt;
}

Expected<MeshFile> parse_mesh(std::string_view bytes, MeshFormat format, const MeshLimits& limits) {
  // Indices have 32 bits, and STL has three vertices for each triangle.
  constexpr std::size_t kMaxTriangles = std::size_t{1} << 26;
  if (bytes.size() > limits.max_bytes) {
    return tl::make_unexpected(
        Error{Errc::unsupported, "more than " + std::to_string(limits.max_bytes >> 20) + " MiB"});
  }
  try {  // the standard library throws
    return parse(bytes, format, std::min(limits.max_triangles, kMaxTriangles));
  } catch (const std::exception& thrown) {
    return tl::make_unexpected(
        Error{Errc::bad_data, std::string("it cannot be read: ") + thrown.what()});
  }
}

Expected<MeshFile> load_mesh(const std::string& path, const MeshLimits& limits) {
  const auto format = mesh_format(path);
  if (!format) {
    return tl::make_unexpected(
        Error{Errc::unsupported, path + ": not a name of a mesh that is read: .stl, .obj or .dae"});
  }
  const auto bytes = detail::read_file(path, limits.max_bytes);
  if (!bytes) return tl::make_unexpected(bytes.error());
  auto mesh = parse_mesh(*bytes, *format, limits);
  if (!mesh) mesh.error().message.insert(0, path + ": ");
  return mesh;
}

}  // namespace vp
