// Shapes on surfaces and compounds, for the tests of their contacts.
#pragma once

#include <algorithm>
#include <vector>

#include "collide/manifolds.h"
#include "random.h"
#include "vphysics/convex_hull.h"

namespace vp::test {

inline ConvexHull rock(Random& random, double size, int points) {
  std::vector<Vec3> p;
  for (int i = 0; i < points; ++i) p.push_back(size * random.direction());
  return ConvexHull::of(p).value();
}

// One shape of each convex kind, about half a metre in size.
inline std::vector<Shape> convex_shapes() {
  Random random(31);
  return {Sphere{0.25},    Box{{0.3, 0.2, 0.1}},   Capsule{0.1, 0.2},   Cylinder{0.2, 0.15},
          Cone{0.2, 0.25}, rock(random, 0.25, 30), Box{{0.4, 0.4, 0.4}}};
}

struct Found {
  std::vector<collide::SubManifold> manifolds;

  double deepest() const {
    double least = 1e300;
    for (const collide::SubManifold& s : manifolds) {
      for (int i = 0; i < s.manifold.count; ++i) {
        least = std::min(least, s.manifold.points[i].separation);
      }
    }
    return least;
  }
};

inline Found find(const Shape& a, const SE3& T_a, const Shape& b, const SE3& T_b,
                  const collide::SearchMargin& margin) {
  Found found;
  collide::ManifoldScratch scratch;
  collide::PairCache cache;
  find_manifolds(collide::make_geometry(a), T_a, collide::make_geometry(b), T_b, margin, cache, {},
                 scratch, found.manifolds);
  return found;
}

}  // namespace vp::test
