// parse_mesh on untrusted bytes. The first byte selects the format. An error has a message. Shapes
// are built from every accepted mesh.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "vphysics/convex_hull.h"
#include "vphysics/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vp;
  if (size < 1) return 0;
  const auto format = static_cast<MeshFormat>(data[0] % 3);
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto mesh = parse_mesh(bytes, format, {.max_bytes = 1 << 20, .max_triangles = 1000});
  if (!mesh) {
    if (mesh.error().message.empty()) std::abort();
    return 0;
  }
  if (mesh->vertices.empty() || mesh->triangles.size() > 1000) std::abort();
  for (const Vec3& v : mesh->vertices) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) std::abort();
  }
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh->vertices.size()) std::abort();
    }
  }
  std::size_t before = 0;
  for (const std::size_t first : mesh->objects) {
    if (first >= mesh->triangles.size() || (first <= before && first != 0)) std::abort();
    before = first;
  }
  (void)ConvexHull::of(mesh->vertices);
  (void)TriangleMesh::of(mesh->vertices, mesh->triangles);
  return 0;
}
