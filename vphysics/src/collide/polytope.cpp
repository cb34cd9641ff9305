#include "collide/polytope.h"

#include <cstring>

#include "collide/bounds.h"
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

namespace {

// Four numbers in parallel; one or two at a time if the machine has no such registers.
using Four [[gnu::vector_size(32)]] = double;
// The first of the vertices that are farthest along d.
[[gnu::always_inline]] inline int scan_vertices(const HullData& hull, const Vec3& d) {
  const std::size_t n = hull.support_x.size();
  Four largest{-kFar, -kFar, -kFar, -kFar}, found{}, at{0.0, 1.0, 2.0, 3.0};
  for (std::size_t i = 0; i < n; i += kSupportLanes) {
    Four x, y, z;
    std::memcpy(&x, &hull.support_x[i], sizeof x);
    std::memcpy(&y, &hull.support_y[i], sizeof y);
    std::memcpy(&z, &hull.support_z[i], sizeof z);
    const Four along = d.x * x + d.y * y + d.z * z;
    const auto farther = along > largest;
    largest = farther ? along : largest;
    found = farther ? at : found;
    at += static_cast<double>(kSupportLanes);
  }
  int best = 0;
  for (int lane = 1; lane < static_cast<int>(kSupportLanes); ++lane) {
    if (largest[lane] > largest[best] ||
        (largest[lane] == largest[best] && found[lane] < found[best]))
      best = lane;
  }
  return static_cast<int>(found[best]);
}

int farthest_vertex(const HullData& hull, const Vec3& d) {
  return scan_vertices(hull, d);
}
#ifdef VP_INSTRUCTION_SETS
// To the same bits: nothing is fused.
[[gnu::target("avx2")]] int farthest_vertex_avx2(const HullData& hull, const Vec3& d) {
  return scan_vertices(hull, d);
}
#endif

using Scan = int (*)(const HullData& hull, const Vec3& d);
Scan scan_of_this_machine() {
#ifdef VP_INSTRUCTION_SETS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2")) return farthest_vertex_avx2;
#endif
  return farthest_vertex;
}

}  // namespace

int support_vertex(const HullData& hull, const Vec3& d, int hint) {
  if (!hull.support_x.empty()) {
    static const Scan scan = scan_of_this_machine();
    return scan(hull, d);
  }
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
