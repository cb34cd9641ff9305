#include "collide/polytope.h"

#include "collide/support.h"

namespace vp::collide {

PolytopeOf::PolytopeOf(const Geometry& g) {
  if (g.kind == Kind::hull) {
    view_ = {g.hull->vertices, g.hull->faces, g.hull->edges};
    return;
  }
  for (int i = 0; i < 8; ++i) vertices_[static_cast<std::size_t>(i)] = box_corner(g.half, i);
  for (std::size_t f = 0; f < 6; ++f) {
    const int axis = kBoxFaceAxis[f];
    faces_[f] = {{}, g.half[axis], kBoxCorners[f]};
    faces_[f].normal[axis] = kBoxFaceSide[f];
  }
  view_ = {vertices_, faces_, kBoxEdges};
}

int support_vertex(const HullData& hull, const Vec3& d, int hint) {
  constexpr int kFew = 16;
  const int n = static_cast<int>(hull.vertices.size());
  int best = 0;
  if (n <= kFew) {
    double most = dot(d, hull.vertices[0]);
    for (int i = 1; i < n; ++i) {
      const double along = dot(d, hull.vertices[static_cast<std::size_t>(i)]);
      if (along > most) {
        most = along;
        best = i;
      }
    }
    return best;
  }
  if (hint > 0 && hint < n) best = hint;
  double most = dot(d, hull.vertices[static_cast<std::size_t>(best)]);
  for (int from = -1; from != best;) {
    from = best;
    const auto v = static_cast<std::size_t>(from);
    for (std::size_t k = hull.first_around[v]; k < hull.first_around[v + 1]; ++k) {
      const double along = dot(d, hull.vertices[hull.neighbours[k]]);
      if (along > most) {
        most = along;
        best = hull.neighbours[k];
      }
    }
  }
  return best;
}

}  // namespace vp::collide
