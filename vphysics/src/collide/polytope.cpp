#include "collide/polytope.h"

#include "collide/support.h"

namespace vp::collide {

PolytopeOf::PolytopeOf(const Geometry& g) {
  if (g.kind == Kind::hull) {
    view_ = {g.hull->vertices, g.hull->faces, g.hull->edges, &g.hull->scanned_faces};
    return;
  }
  for (int i = 0; i < 8; ++i) vertices_[static_cast<std::size_t>(i)] = box_corner(g.half, i);
  for (std::size_t f = 0; f < 6; ++f) {
    const int axis = kBoxFaceAxis[f];
    faces_[f] = {{}, g.half[axis], kBoxCorners[f]};
    faces_[f].normal[axis] = kBoxFaceSide[f];
  }
  view_ = {vertices_, faces_, kBoxEdges, nullptr};
}

int face_towards(const Polytope& p, const Vec3& d) {
  if (p.planes != nullptr) return farthest_along(p.planes->normal, d);
  std::size_t best = 0;
  for (std::size_t f = 1; f < p.faces.size(); ++f) {
    if (dot(p.faces[f].normal, d) > dot(p.faces[best].normal, d)) best = f;
  }
  return static_cast<int>(best);
}

std::uint64_t faces_behind(const Polytope& p, std::size_t first, const Vec3& x, const Vec3& y,
                           double distance) {
  if (p.planes != nullptr) return planes_behind(*p.planes, first, x, y, distance);
  std::uint64_t found = 0;
  for (std::size_t f = first; f < p.faces.size(); ++f) {
    if (is_behind(p.faces[f], x, y, distance)) found |= std::uint64_t{1} << (f - first);
  }
  return found;
}

int support_vertex(const HullData& hull, const Vec3& d, int hint) {
  if (!hull.scanned_vertices.empty()) return farthest_along(hull.scanned_vertices, d);
  const int n = static_cast<int>(hull.vertices.size());
  int best = 0;
  if (hint > 0 && hint < n) best = hint;
  double largest = dot(d, hull.vertices[static_cast<std::size_t>(best)]);
  for (int from = -1; from != best;) {
    from = best;
    const auto v = static_cast<std::size_t>(from);
    for (std::size_t k = hull.first_around[v]; k < hull.first_around[v + 1]; ++k) {
      const double along = dot(d, hull.vertices[hull.neighbours[k]]);
      if (along > largest) {
        largest = along;
        best = hull.neighbours[k];
      }
    }
  }
  return best;
}

}  // namespace vp::collide
