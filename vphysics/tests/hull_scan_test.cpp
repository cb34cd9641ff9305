// Scans over vertices and faces of hulls, and the axes of overlapping polytopes that rest on them.
#include "collide/hull_scan.h"

#include <gtest/gtest.h>

#include <limits>

#include "collide/convex_contact.h"
#include "collide/polytope.h"
#include "surfaces.h"

namespace vp::test {
namespace {

using collide::Geometry;

collide::ScanList list_of(const std::vector<Vec3>& vectors) {
  collide::ScanList list;
  for (const Vec3& v : vectors) list.add(v);
  while (!list.is_whole()) list.add(vectors[0]);
  return list;
}

// Coordinates of few values, so that many vectors are equally far.
std::vector<Vec3> coarse_vectors(Random& random, int count) {
  std::vector<Vec3> vectors;
  for (int i = 0; i < count; ++i) {
    const Vec3 v = random.in_cube(3.0);
    vectors.push_back({std::round(v.x), std::round(v.y), std::round(v.z)});
  }
  return vectors;
}

TEST(HullScan, FindsTheFirstOfTheFarthest) {
  Random random(71);
  for (int count = 1; count <= 64; ++count) {
    const std::vector<Vec3> vectors = coarse_vectors(random, count);
    const collide::ScanList list = list_of(vectors);
    for (int i = 0; i < 50; ++i) {
      const Vec3 d = i % 2 == 0 ? random.direction() : coarse_vectors(random, 1)[0];
      std::size_t first = 0;
      for (std::size_t k = 1; k < vectors.size(); ++k) {
        if (dot(d, vectors[k]) > dot(d, vectors[first])) first = k;
      }
      ASSERT_EQ(farthest_along(list, d), static_cast<int>(first)) << count << " vectors";
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(farthest_along(list, {nan, nan, nan}), 0);
  }
}

TEST(HullScan, FindsThePlanesBehindTwoPoints) {
  Random random(72);
  for (const int count : {1, 4, 7, 8, 20, 63, 64, 65, 130}) {
    collide::ScanPlanes planes;
    for (int i = 0; i < count; ++i) {
      planes.normal.add(random.direction());
      planes.offset.push_back(random.uniform(-0.2, 0.2));
    }
    while (!planes.normal.is_whole()) {
      planes.normal.add({});
      planes.offset.push_back(1e30);
    }
    for (int i = 0; i < 50; ++i) {
      const Vec3 p = random.in_cube(1.0), q = random.in_cube(1.0);
      const double distance = random.uniform(-0.5, 0.5);
      for (std::size_t first = 0; first < planes.offset.size(); first += 64) {
        const std::uint64_t found = planes_behind(planes, first, p, q, distance);
        for (std::size_t f = first; f < first + 64; ++f) {
          bool behind = false;
          if (f < static_cast<std::size_t>(count)) {
            const Vec3 n{planes.normal.x[f], planes.normal.y[f], planes.normal.z[f]};
            behind =
                dot(n, p) - planes.offset[f] > distance && dot(n, q) - planes.offset[f] > distance;
          }
          ASSERT_EQ((found >> (f - first) & 1u) != 0, behind) << count << " planes, " << f;
        }
      }
    }
  }
}

TEST(HullScan, FindsTheVectorsBetweenTwo) {
  Random random(73);
  for (const int count : {1, 8, 9, 50, 64}) {
    const std::vector<Vec3> vectors = coarse_vectors(random, count);
    const collide::ScanList list = list_of(vectors);
    for (int i = 0; i < 50; ++i) {
      const Vec3 p = coarse_vectors(random, 1)[0], q = random.direction();
      const std::uint64_t found = collide::vectors_between(list.x.data(), list.y.data(),
                                                           list.z.data(), list.x.size(), p, q);
      for (std::size_t k = 0; k < vectors.size(); ++k)
        ASSERT_EQ((found >> k & 1u) != 0, dot(p, vectors[k]) * dot(q, vectors[k]) < 0.0);
    }
  }
}

// The largest separation along all faces' normals and all products of edges.
double best_separation(const collide::CorePair& pair) {
  const collide::PolytopeOf a(pair.a), b(pair.b);
  double best = -1e300;
  const auto try_axis = [&](const Vec3& n) {
    best = std::max(best, collide::separation_along(pair, n));
  };
  for (const ConvexHull::Face& f : a.view().faces) try_axis(f.normal);
  for (const ConvexHull::Face& f : b.view().faces) try_axis(-pair.T_a_b.rotate(f.normal));
  for (const collide::HullEdge& e : a.view().edges) {
    const Vec3 of_a = a.view().vertices[e.v1] - a.view().vertices[e.v0];
    for (const collide::HullEdge& g : b.view().edges) {
      const Vec3 n =
          cross(of_a, pair.T_a_b.rotate(b.view().vertices[g.v1] - b.view().vertices[g.v0]));
      if (norm(n) < 1e-9) continue;
      try_axis((1.0 / norm(n)) * n);
      try_axis((-1.0 / norm(n)) * n);
    }
  }
  return best;
}

// Whatever the cache says, also with more than 64 faces.
TEST(OverlapAxes, AreTheBestOfAllFacesAndEdges) {
  Random random(74);
  const auto rock = [&](int points) {
    std::vector<Vec3> p;
    for (int i = 0; i < points; ++i) p.push_back(0.3 * random.direction());
    return ConvexHull::of(p).value();
  };
  const std::vector<Shape> shapes{Box{{0.3, 0.2, 0.25}}, rock(8), rock(25), rock(60)};
  int overlapping = 0;
  for (const Shape& first : shapes) {
    for (const Shape& second : shapes) {
      const Geometry a = collide::make_geometry(first), b = collide::make_geometry(second);
      for (int i = 0; i < 40; ++i) {
        const collide::CorePair pair(a, b, SE3(random.rotation(), random.in_cube(0.3)));
        if (collide::gjk(pair, {0, 0, 1}, 0.0).state != collide::GjkResult::State::overlaps)
          continue;
        ++overlapping;
        const double truth = best_separation(pair);
        for (int k = 0; k < 4; ++k) {
          collide::PairCache cache;
          const Vec3 normal = k == 0 ? Vec3{} : random.direction();
          for (int c = 0; c < 3; ++c) cache.normal[c] = static_cast<float>(normal[c]);
          collide::FaceAxis face;
          collide::EdgeAxis edge;
          collide::find_overlap_axes(pair, 0.0, cache, face, edge);
          EXPECT_NEAR(edge.better ? edge.axis.separation : face.separation, truth, 1e-12);
        }
      }
    }
  }
  EXPECT_GT(overlapping, 200);
}

// A corner inside all planes proves an overlap, but not with merged faces: their corners lie behind
// the planes, and what is between is outside.
TEST(OverlapAxes, AreNotSearchedBetweenAMergedFaceAndItsCorners) {
  std::vector<Vec3> corners;  // of a box, one of them moved into it
  for (int i = 0; i < 8; ++i)
    corners.push_back({i & 1 ? 0.25 : -0.25, i & 2 ? 0.25 : -0.25, i & 4 ? 0.25 : -0.25});
  corners.back() -= Vec3{0, 0, 1e-3};
  const ConvexHull merged = ConvexHull::of(corners, {.tolerance = 1e-2}).value();
  ASSERT_EQ(merged.faces().size(), 6u);
  const std::vector<Vec3> points{{0, 0, 0}, {0.1, 0, 0.3}, {-0.1, 0.1, 0.3}, {-0.1, -0.1, 0.3}};
  const ConvexHull tip = ConvexHull::of(points).value();
  const Geometry a = collide::make_geometry(merged), b = collide::make_geometry(tip);
  const Vec3 between{0.2499, 0.2499, 0.2495};
  const collide::CorePair pair(a, b, SE3(between));
  const double distance = collide::gjk(pair, {0, 0, 1}, 1.0).distance;
  ASSERT_GT(distance, 1e-4);
  collide::PairCache cache;
  cache.normal[2] = 1.0f;
  collide::Manifold manifold;
  collide::collide_convex(pair, 0.01, cache, manifold);
  EXPECT_NEAR(manifold.min_separation, distance, 1e-12);
}

}  // namespace
}  // namespace vp::test
