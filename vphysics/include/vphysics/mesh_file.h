// Triangle meshes from files: STL (binary and text), Wavefront OBJ and COLLADA.
//
// Part of the library VirtualPhysics::urdf. It reads vertices and faces only, no normals, colours
// or textures. Lengths are in the file's unit. COLLADA states its unit, so its lengths are in
// metres. Nothing is printed, nothing is thrown, and numbers parse the same in every locale. Any
// number of threads may read at once.
//
//   const auto file = vp::load_mesh("terrain.obj");
//   if (file) collider.shape = vp::TriangleMesh::of(file->vertices, file->triangles).value();
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vphysics/error.h"
#include "vphysics/lie.h"
#include "vphysics/triangle_mesh.h"

namespace vp {

enum class MeshFormat : std::uint8_t { stl, obj, collada };

struct MeshLimits {
  std::size_t max_bytes = std::size_t{64} << 20;  // of a file
  std::size_t max_triangles = 1'000'000;
};

struct MeshFile {
  std::vector<Vec3> vertices{};  // STL: three for each triangle
  std::vector<TriangleMesh::Triangle> triangles{};
  // The first triangle of each object: each o or g of an OBJ, each geometry instance of a COLLADA
  // scene. Convex decompositions of collision meshes are such files.
  std::vector<std::size_t> objects{};
  // Number of rejected faces: a vertex index is out of range, a vertex is not finite, or the face
  // has fewer than three corners.
  std::size_t left_out = 0;
};

// From the file name extension: .stl, .obj or .dae, in any case. Empty for other names.
std::optional<MeshFormat> mesh_format(std::string_view path);

// STL: three vertices for each triangle; the stored normal is ignored. OBJ: polygons are split into
// triangles from their first corner; indices may count from the end. COLLADA: triangles, polylists
// and polygons, with the poses of the scene's nodes; the up axis is ignored, as in RViz.
// Errc::bad_data: bytes without a vertex, truncated binary STL, text that is not well-formed XML.
// Errc::unsupported: more bytes or triangles than the limits, or more than 3 max_triangles
// vertices.
[[nodiscard]] Expected<MeshFile> parse_mesh(std::string_view bytes, MeshFormat format,
                                            const MeshLimits& limits = {});
// Reads a file. Errc::unsupported also if the extension is unknown. The message begins with the
// path.
[[nodiscard]] Expected<MeshFile> load_mesh(const std::string& path, const MeshLimits& limits = {});

}  // namespace vp
