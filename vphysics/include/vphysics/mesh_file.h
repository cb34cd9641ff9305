// Triangles from files: STL (binary and text), Wavefront OBJ and COLLADA.
//
// Of the library VirtualPhysics::urdf. Corners and faces alone are read: no normals, colours or
// textures. Lengths are the file's, but for COLLADA, which says its unit: metres. Nothing is
// printed, nothing is thrown, and numbers read the same in every locale. Any number of threads may
// read at once.
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
  std::vector<Vec3> vertices{};  // of STL three for each triangle
  std::vector<TriangleMesh::Triangle> triangles{};
  // The first triangle of each object: of what an OBJ names by o or g, of each geometry that a
  // COLLADA scene places. Collision meshes that were taken apart into convex pieces are such files.
  std::vector<std::size_t> objects{};
  // Faces that name no vertex or one whose numbers are not finite, or that have fewer than three
  // corners.
  std::size_t left_out = 0;
};

// By the end of the name, .stl, .obj or .dae in any case; none of other names.
std::optional<MeshFormat> mesh_format(std::string_view path);

// STL: three corners each, whichever way the stored normal points. OBJ: polygons are cut into
// triangles from their first corner; indices may count from the end. COLLADA: triangles, polylists
// and polygons, where the scene's nodes put them; which axis is up is not regarded, as RViz has it.
// Refused with Errc::bad_data: bytes without a vertex, binary STL that is cut short, text that is
// not well-formed XML; with Errc::unsupported: more bytes or triangles than the limits, or three
// times as many vertices.
[[nodiscard]] Expected<MeshFile> parse_mesh(std::string_view bytes, MeshFormat format,
                                            const MeshLimits& limits = {});
// The same from a file; Errc::unsupported too where its name has no known end. The message begins
// with the path.
[[nodiscard]] Expected<MeshFile> load_mesh(const std::string& path, const MeshLimits& limits = {});

}  // namespace vp
