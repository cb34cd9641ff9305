#include "urdf_world/mesh_shape.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace vp::detail {
namespace {

// Half of the thickness given to a flat mesh, as a fraction of its extent.
constexpr double kThickening = 1e-3;

double extent_of(std::span<const Vec3> points) {
  Vec3 lower = points.front(), upper = points.front();
  for (const Vec3& p : points) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], p[k]);
      upper[k] = std::max(upper[k], p[k]);
    }
  }
  const Vec3 size = upper - lower;
  return std::max({size.x, size.y, size.z});
}

// Replaces each point by the corners of a small cube, so that a plate, a wire or a single point has
// a volume.
std::vector<Vec3> thickened(std::span<const Vec3> points) {
  const double t = std::max(kThickening * extent_of(points), 1e-6);
  std::vector<Vec3> out;
  out.reserve(8 * points.size());
  for (const Vec3& p : points) {
    for (int corner = 0; corner < 8; ++corner) {
      out.push_back(p + Vec3{corner & 1 ? t : -t, corner & 2 ? t : -t, corner & 4 ? t : -t});
    }
  }
  return out;
}

Expected<ConvexHull> hull_of(std::span<const Vec3> points, const HullOptions& options,
                             bool& is_flat) {
  auto hull = ConvexHull::of(points, options);
  if (hull) return hull;
  auto thick = ConvexHull::of(thickened(points), options);
  if (!thick) return hull;  // the error of the original points
  is_flat = true;
  return thick;
}

// The points of the triangles [first, last).
std::vector<Vec3> points_of(const MeshFile& mesh, std::span<const Vec3> vertices, std::size_t first,
                            std::size_t last) {
  std::vector<std::uint32_t> named;
  for (std::size_t t = first; t < last; ++t) {
    named.insert(named.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  std::vector<Vec3> out;
  out.reserve(named.size());
  for (const std::uint32_t i : named) out.push_back(vertices[i]);
  return out;
}

Expected<Shape> shape_of_hulls(const MeshFile& mesh, std::span<const Vec3> vertices,
                               const UrdfWorldOptions& options, bool& is_flat) {
  const std::size_t objects = mesh.objects.size();
  if (objects <= 1 || objects > options.max_hulls) {
    const std::vector<Vec3> used = points_of(mesh, vertices, 0, mesh.triangles.size());
    auto hull =
        hull_of(used.empty() ? vertices : std::span<const Vec3>(used), options.hull, is_flat);
    if (!hull) return tl::make_unexpected(std::move(hull.error()));
    return *std::move(hull);
  }
  std::vector<CompoundPart> parts;
  for (std::size_t k = 0; k < objects; ++k) {
    const std::size_t last = k + 1 < objects ? mesh.objects[k + 1] : mesh.triangles.size();
    auto hull = hull_of(points_of(mesh, vertices, mesh.objects[k], last), options.hull, is_flat);
    if (!hull) return tl::make_unexpected(std::move(hull.error()));
    parts.push_back({*std::move(hull), SE3()});
  }
  auto compound = Compound::of(parts);
  if (!compound) return tl::make_unexpected(std::move(compound.error()));
  return *std::move(compound);
}

}  // namespace

Expected<MadeShape> shape_of_mesh(const MeshFile& mesh, const Vec3& scale, bool triangles,
                                  const UrdfWorldOptions& options) {
  std::vector<Vec3> vertices(mesh.vertices.size());
  std::transform(mesh.vertices.begin(), mesh.vertices.end(), vertices.begin(), [&](const Vec3& v) {
    return Vec3{v.x * scale.x, v.y * scale.y, v.z * scale.z};
  });
  std::string note;
  if (mesh.left_out != 0) note = std::to_string(mesh.left_out) + " of its faces are left out; ";
  if (triangles) {
    std::vector<TriangleMesh::Triangle> faces = mesh.triangles;
    if (scale.x * scale.y * scale.z < 0.0) {  // mirrored: reverse the winding
      for (auto& face : faces) std::swap(face[1], face[2]);
    }
    if (auto made = TriangleMesh::of(vertices, faces, options.triangles)) {
      return MadeShape{*std::move(made), note};
    }
    note += "it has no triangles with an area, and becomes a hull; ";
  }
  bool is_flat = false;
  auto shape = shape_of_hulls(mesh, vertices, options, is_flat);
  if (!shape) return tl::make_unexpected(std::move(shape.error()));
  if (is_flat) note += "it is flat, and given a thickness of a five-hundredth of its extent; ";
  return MadeShape{*std::move(shape), note};
}

}  // namespace vp::detail
