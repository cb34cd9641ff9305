// The search margin of moving convex shapes against fine samples of their motion.
#include "collide/pair_margin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "collide/distance.h"
#include "collide/gjk.h"
#include "collide/manifold.h"
#include "collide/time_of_impact.h"
#include "random.h"
#include "shape_truth.h"

namespace vp::test {
namespace {

using collide::Manifold;
using collide::MovingShape;
using collide::PairCache;
using collide::PairMargin;
using collide::PairMotion;

constexpr double kTime = 1.0 / 60, kMarginSlack = 1e-3;
constexpr int kMarginSamples = 120;

// A shape whose body rotates about a point beside it.
MovingShape thrown(Random& random, const Geometry& shape, const SE3& T) {
  const Vec3 about = random.in_cube(0.3), v = random.in_cube(15.0), w = random.in_cube(25.0);
  return {&shape, T, {T * about, v, w}};
}

double smallest_separation(const MovingShape& a, const MovingShape& b) {
  double least = 1e300;
  for (int k = 0; k <= 40; ++k) {
    const double t = kTime * k / 40;
    PairCache cache;
    least = std::min(
        least, closest_points(*a.shape, pose_at(a, t), *b.shape, pose_at(b, t), cache).distance);
  }
  return least;
}

// Of both: the farthest that a point moves.
double largest_margin(const MovingShape& a, const MovingShape& b) {
  const auto moves = [](const MovingShape& m) {
    const double reach = norm(m.T.position() - m.motion.x) + norm(core_centre(*m.shape)) +
                         core_extent(*m.shape) + core_radius(*m.shape);
    return kTime * (norm(m.motion.v) + reach * norm(m.motion.w));
  };
  return kMarginSlack + moves(a) + moves(b);
}

// How far the manifold's normal separates the two.
double separation_by_normal(const MovingShape& a, const MovingShape& b, const Vec3& n) {
  const collide::CorePair pair(*a.shape, *b.shape, collide::relative_pose(a.T, b.T));
  return separation_along(pair, a.T.unrotate(n)) - core_radius(*a.shape) - core_radius(*b.shape);
}

class EveryPairsMargin : public ::testing::TestWithParam<std::pair<Kind, Kind>> {};

std::vector<std::pair<Kind, Kind>> all_pairs_of_kinds() {
  std::vector<std::pair<Kind, Kind>> pairs;
  for (const Kind a : kBounded)
    for (const Kind b : kBounded) pairs.emplace_back(a, b);
  return pairs;
}

TEST_P(EveryPairsMargin, LeavesOutOnlyWhatDoesNotTouch) {
  Random random(85);
  const auto [kind_a, kind_b] = GetParam();
  int passes = 0, left_out = 0;
  for (int i = 0; i < kMarginSamples; ++i) {
    const Solid solid_a = random_solid(random, kind_a), solid_b = random_solid(random, kind_b);
    const SE3 T_a = random.pose(0.4), T_b = random.pose(1.2);
    const MovingShape a = thrown(random, solid_a.geometry, T_a),
                      b = thrown(random, solid_b.geometry, T_b);
    const double largest = largest_margin(a, b);
    const PairMotion motion{a.motion, b.motion, kTime, 0.0};
    const PairMargin margin(largest, kMarginSlack, motion, {solid_a.geometry, T_a},
                            {solid_b.geometry, T_b});
    PairCache cache;
    Manifold first, second;
    find_manifold(solid_a.geometry, T_a, solid_b.geometry, T_b, margin, cache, first);
    find_manifold(solid_a.geometry, T_a, solid_b.geometry, T_b, margin, cache, second);
    const double closest = smallest_separation(a, b);
    for (const Manifold& m : {first, second}) {
      if (m.count > 0) continue;
      EXPECT_GT(closest, 0.0) << i;
      ASSERT_NEAR(norm(m.normal), 1.0, 1e-9);
      EXPECT_GE(separation_by_normal(a, b, m.normal), m.min_separation - 1e-9) << i;
    }
    PairCache fresh;
    const double now = closest_points(solid_a.geometry, T_a, solid_b.geometry, T_b, fresh).distance;
    if (now > largest || closest < 0.05) continue;
    ++passes;
    left_out += first.count == 0 ? 1 : 0;
  }
  EXPECT_GT(passes, 15);
  EXPECT_GT(left_out, 0.6 * passes);
}

INSTANTIATE_TEST_SUITE_P(Convex, EveryPairsMargin, ::testing::ValuesIn(all_pairs_of_kinds()));

}  // namespace
}  // namespace vp::test
