// Distance and penetration of every pair of convex shapes. The separation along any direction is a
// lower bound of the true separation, so each result's own normal proves it from below. A search
// over directions with support functions of the tests checks it from above. Polytopes are also
// checked by brute force over all their features. PAIRS is the number of samples for each pair.
#include "collide/distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "random.h"
#include "shape_truth.h"

namespace vp::test {
namespace {

#ifdef PAIRS
constexpr int kDistanceSamples = PAIRS;
#else
constexpr int kDistanceSamples = 12;
#endif

using collide::ClosestPoints;
using collide::PairCache;

// Tolerance. Where curved shapes overlap, the result is accurate to 1e-9 of both sizes and their
// distance.
constexpr double kNear = 2e-8;

class EveryPairsDistance : public ::testing::TestWithParam<std::pair<Kind, Kind>> {};

std::vector<std::pair<Kind, Kind>> unordered_pairs() {
  std::vector<std::pair<Kind, Kind>> pairs;
  for (const Kind a : kBounded) {
    for (const Kind b : kBounded) {
      if (a <= b) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

TEST_P(EveryPairsDistance, IsAsFarApartAsItsNormalProvesAndNoDirectionTellsMore) {
  Random random(61);
  const auto [ka, kb] = GetParam();
  for (int i = 0; i < kDistanceSamples; ++i) {
    const Solid a = random_solid(random, ka), b = random_solid(random, kb);
    const SE3 Ta = random.pose(0.4), Tb = random.pose(1.0);
    const ClosestPoints c = closest(a, Ta, b, Tb);
    ASSERT_NEAR(norm(c.normal), 1.0, 1e-14);
    // Lower bound. Measured: 6e-11 at worst, of two cylinders.
    ASSERT_NEAR(separation_along(a.geometry, Ta, b.geometry, Tb, c.normal), c.distance, 1e-9) << i;
    // Upper bound. Measured: 8e-10 at worst, of a box and a cone.
    ASSERT_LT(sampled_separation(random, a.geometry, Ta, b.geometry, Tb), c.distance + kNear) << i;
    ASSERT_LT(norm(c.on_b - c.on_a - c.distance * c.normal), 1e-8) << i;
    // Both points are on the surfaces. Measured: 4e-8, where a rim is deep in a hull.
    ASSERT_NEAR(signed_distance(a.geometry, inverse_times(Ta, c.on_a)).distance, 0.0, 2e-7) << i;
    ASSERT_NEAR(signed_distance(b.geometry, inverse_times(Tb, c.on_b)).distance, 0.0, 2e-7) << i;
  }
}

TEST_P(EveryPairsDistance, IsTheSameSwappedScaledAndFarFromTheOrigin) {
  Random random(62);
  const auto [ka, kb] = GetParam();
  for (int i = 0; i < 4 * kDistanceSamples; ++i) {
    const Solid a = random_solid(random, ka), b = random_solid(random, kb);
    const SE3 Ta = random.pose(0.4), Tb = random.pose(1.0);
    const ClosestPoints c = closest(a, Ta, b, Tb), swapped = closest(b, Tb, a, Ta);
    ASSERT_NEAR(c.distance, swapped.distance, kNear);
    const Vec3 far{1e6, -1e6, 3e5};  // where positions have a spacing of 1e-10
    const ClosestPoints moved = closest(a, SE3(Ta.rotation(), Ta.position() + far), b,
                                        SE3(Tb.rotation(), Tb.position() + far));
    ASSERT_NEAR(c.distance, moved.distance, kNear);
    const double k = std::pow(10.0, random.uniform(-3, 3));
    const Solid ak(scaled(a.shape, {k, k, k}).value()), bk(scaled(b.shape, {k, k, k}).value());
    const ClosestPoints large = closest(ak, SE3(Ta.rotation(), k * Ta.position()), bk,
                                        SE3(Tb.rotation(), k * Tb.position()));
    ASSERT_NEAR(c.distance, large.distance / k, kNear);
  }
}

TEST_P(EveryPairsDistance, OverlapsWhereItsDistanceIsNegative) {
  Random random(63);
  const auto [ka, kb] = GetParam();
  int met = 0;
  for (int i = 0; i < 4 * kDistanceSamples; ++i) {
    const Solid a = random_solid(random, ka), b = random_solid(random, kb);
    const SE3 Ta = random.pose(0.4), Tb = random.pose(1.0);
    const double distance = closest(a, Ta, b, Tb).distance;
    PairCache cache;
    const bool met_now = shapes_overlap(a.geometry, Ta, b.geometry, Tb, cache);
    if (std::fabs(distance) > 1e-9) {
      ASSERT_EQ(met_now, distance < 0.0) << distance;
      ASSERT_EQ(shapes_overlap(b.geometry, Tb, a.geometry, Ta, cache),
                met_now);  // of the other order
    }
    met += met_now;
  }
  EXPECT_GT(met, 0);
  EXPECT_LT(met, 4 * kDistanceSamples);
}

// A cache gives the starting point of the search. The result is the same from any start, even from
// arbitrary bytes.
TEST_P(EveryPairsDistance, IsTheSameWhateverItsCacheHolds) {
  Random random(64);
  const auto [ka, kb] = GetParam();
  for (int i = 0; i < 4 * kDistanceSamples; ++i) {
    const Solid a = random_solid(random, ka), b = random_solid(random, kb);
    const SE3 Ta = random.pose(0.4), Tb = random.pose(1.0);
    const ClosestPoints c = closest(a, Ta, b, Tb);
    PairCache cache;
    for (int k = 0; k < 4; ++k) {
      if (k > 0) {
        unsigned char bytes[sizeof(PairCache)];
        for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random.word());
        std::memcpy(&cache, bytes, sizeof cache);
        if (k > 1) cache.feature %= 5;
        if (k > 2) cache.i %= 8;
      }
      const ClosestPoints other = closest_points(a.geometry, Ta, b.geometry, Tb, cache);
      ASSERT_NEAR(c.distance, other.distance, kNear);
      const ClosestPoints again = closest_points(a.geometry, Ta, b.geometry, Tb, cache);
      ASSERT_NEAR(c.distance, again.distance, kNear);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Convex, EveryPairsDistance, ::testing::ValuesIn(unordered_pairs()));

// --- polytopes: all features against all

double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  return norm(p - a - std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0) * d);
}

double between_segments(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = d - c, n = cross(u, v);
  const double nn = dot(n, n);
  double least = std::min(
      {to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)});
  if (nn > 1e-24) {
    const double s = dot(cross(c - a, v), n) / nn, t = dot(cross(c - a, u), n) / nn;
    if (s > 0 && s < 1 && t > 0 && t < 1)
      least = std::min(least, std::fabs(dot(n, c - a)) / std::sqrt(nn));
  }
  return least;
}

struct Corners {
  std::vector<Vec3> vertices;
  std::vector<std::vector<std::size_t>> faces;
};
Corners corners_of(const Solid& solid, const SE3& T) {
  Corners found;
  const Shape& shape = solid.shape;
  const ConvexHull hull = std::holds_alternative<Box>(shape)
                              ? hull_of(box_corners(std::get<Box>(shape).half_extents))
                              : std::get<ConvexHull>(shape);
  for (const Vec3& v : hull.vertices()) found.vertices.push_back(T * v);
  for (const auto& face : hull.faces())
    found.faces.emplace_back(face.vertices.begin(), face.vertices.end());
  return found;
}

// The separation along n, between the support points.
double corner_gap(const Corners& a, const Corners& b, const Vec3& n) {
  double front = -1e300, back = 1e300;
  for (const Vec3& p : a.vertices) front = std::max(front, dot(n, p));
  for (const Vec3& p : b.vertices) back = std::min(back, dot(n, p));
  return back - front;
}

double brute_force_separation(const Corners& a, const Corners& b) {
  double best = -1e300;
  const auto try_axis = [&](const Vec3& n) {
    const double length = norm(n);
    if (length < 1e-9) return;
    for (const double sign : {1.0, -1.0})
      best = std::max(best, corner_gap(a, b, (sign / length) * n));
  };
  const auto edge = [](const Corners& c, std::size_t f, std::size_t i) {
    const auto& loop = c.faces[f];
    return std::pair{c.vertices[loop[i]], c.vertices[loop[(i + 1) % loop.size()]]};
  };
  for (const Corners* c : {&a, &b}) {
    for (std::size_t f = 0; f < c->faces.size(); ++f) {
      const auto [p, q] = edge(*c, f, 0);
      try_axis(cross(q - p, edge(*c, f, 1).second - q));
    }
  }
  double least = 1e300;
  for (std::size_t f = 0; f < a.faces.size(); ++f) {
    for (std::size_t i = 0; i < a.faces[f].size(); ++i) {
      for (std::size_t g = 0; g < b.faces.size(); ++g) {
        for (std::size_t k = 0; k < b.faces[g].size(); ++k) {
          const auto [p, q] = edge(a, f, i);
          const auto [r, s] = edge(b, g, k);
          try_axis(cross(q - p, s - r));
          least = std::min(least, between_segments(p, q, r, s));
        }
      }
    }
  }
  if (best <= 0.0) return best;
  // Separated: edge pairs are done above; vertices against faces follow.
  const Corners* pair[2] = {&a, &b};
  for (int side = 0; side < 2; ++side) {
    for (const Vec3& p : pair[side]->vertices) {
      const Corners& other = *pair[1 - side];
      for (std::size_t f = 0; f < other.faces.size(); ++f) {
        const auto [q, r] = edge(other, f, 0);
        Vec3 n = cross(r - q, edge(other, f, 1).second - r);
        n = (1.0 / norm(n)) * n;
        bool over = dot(n, p - q) > 0.0;
        for (std::size_t i = 0; over && i < other.faces[f].size(); ++i) {
          const auto [s, t] = edge(other, f, i);
          over = dot(cross(n, t - s), p - s) > 0.0;
        }
        if (over) least = std::min(least, dot(n, p - q));
      }
    }
  }
  return least;
}

TEST(ClosestPoints, OfPolytopesAreThoseOfBruteForce) {
  Random random(65);
  double worst = 0.0;
  int apart = 0;
  for (int i = 0; i < 5 * kDistanceSamples; ++i) {
    const Solid a = random_solid(random, i % 2 ? Kind::box : Kind::hull),
                b = random_solid(random, i % 3 ? Kind::hull : Kind::box);
    const SE3 Ta = random.pose(0.4), Tb = random.pose(1.2);
    const ClosestPoints c = closest(a, Ta, b, Tb);
    const double truth = brute_force_separation(corners_of(a, Ta), corners_of(b, Tb));
    worst = std::max(worst, std::fabs(c.distance - truth));
    apart += truth > 0.0;
  }
  EXPECT_LT(worst, 1e-12);  // measured 4e-15
  EXPECT_GT(apart, kDistanceSamples);
}

TEST(ClosestPoints, OfAHalfSpaceAreBelowTheLowestPoint) {
  Random random(66);
  const Solid ground(HalfSpace{});
  for (const Kind kind : kBounded) {
    for (int i = 0; i < 20; ++i) {
      const Solid a = random_solid(random, kind);
      const SE3 Ta = random.pose(1.0), Tg = random.pose(0.3);
      const ClosestPoints c = closest(a, Ta, ground, Tg), swapped = closest(ground, Tg, a, Ta);
      const Vec3 up = Tg.rotation().cz;
      ASSERT_NEAR(c.distance, dot(up, support(a.geometry, Ta, -up) - Tg.position()), 1e-12);
      ASSERT_LT(norm(c.normal + up), 1e-14);
      ASSERT_LT(norm(swapped.normal - up), 1e-14);
      ASSERT_EQ(swapped.distance, c.distance);
      ASSERT_LT(norm(c.on_b - c.on_a - c.distance * c.normal), 1e-12);
      ASSERT_EQ(swapped.on_a, c.on_b);
    }
  }
}

// Equal centres, axes, faces, and vertices on vertices: cases where search directions vanish.
TEST(ClosestPoints, OfShapesInSymmetricPositionsAreProvenToo) {
  Random random(67);
  const double turns[] = {0.0, kPi / 2, kPi, kPi / 4};
  const Vec3 places[] = {{0, 0, 0}, {0.5, 0, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, 1}, {0, 0, 1e-9}};
  const Solid solids[] = {
      Solid(Sphere{0.5}),          Solid(Capsule{0.5, 0.5}),
      Solid(Box{{0.5, 0.5, 0.5}}), Solid(Cylinder{0.5, 0.5}),
      Solid(Cone{0.5, 0.5}),       Solid(hull_of(box_corners({0.5, 0.5, 0.5})))};
  for (const Solid& a : solids) {
    for (const Solid& b : solids) {
      for (const Vec3& p : places) {
        for (const double turn : turns) {
          for (int axis = 0; axis < 3; ++axis) {
            Vec3 w;
            w[axis] = turn;
            const SE3 Tb(Exp(w), p);
            const ClosestPoints c = closest(a, SE3{}, b, Tb);
            ASSERT_NEAR(norm(c.normal), 1.0, 1e-14);
            const double gap = separation_along(a.geometry, SE3{}, b.geometry, Tb, c.normal);
            ASSERT_NEAR(gap, c.distance, kNear)
                << a.shape.index() << ' ' << b.shape.index() << ' ' << p.x << p.y << p.z << turn;
            // No axis of either shape, and no line between the centres, gives a larger separation.
            for (int k = 0; k < 3; ++k) {
              Vec3 n;
              n[k] = 1.0;
              for (const Vec3& m : {n, -n, Tb.rotate(n), -Tb.rotate(n)}) {
                EXPECT_LE(separation_along(a.geometry, SE3{}, b.geometry, Tb, m),
                          c.distance + kNear)
                    << a.shape.index() << b.shape.index() << " at " << p.x << p.y << p.z
                    << " turned " << turn << " about " << axis;
              }
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace vp::test
