// Times of impact of any two convex shapes against the separation in fine samples of time.
#include "collide/time_of_impact.h"

#include <gtest/gtest.h>

#include "collide/distance.h"
#include "samples.h"
#include "shape_truth.h"

namespace vp::test {
namespace {

using collide::ImpactQuery;
using collide::MovingShape;

double separation_at(const ImpactQuery& q, double t) {
  collide::PairCache fresh;
  return closest_points(*q.a.shape, pose_at(q.a, t), *q.b.shape, pose_at(q.b, t), fresh).distance;
}
double impact_of(const ImpactQuery& q, double target = 0.0) {
  collide::PairCache fresh;
  return time_of_impact(q, target, fresh);
}

MovingShape moving(const Geometry& shape, const SE3& T, const Vec3& v, const Vec3& w,
                   const Vec3& about = {}) {
  return {&shape, T, {T * about, v, w}};
}

// The first sample at or below the given separation; negative if there is none.
double first_sample(const ImpactQuery& q, double level, int samples) {
  for (int k = 0; k <= samples; ++k) {
    const double t = q.duration * k / samples;
    if (separation_at(q, t) <= level) return t;
  }
  return -1.0;
}

struct Outcome {
  int meets = 0, passes = 0;
};

// The time of impact is not later than the first touching sample, the separation then is within the
// tolerance, and without a touching sample there is no impact.
void check(const ImpactQuery& q, Outcome& outcome) {
  if (separation_at(q, 0.0) <= q.tolerance) return;
  const double t = impact_of(q), sampled = first_sample(q, 0.0, 1000);
  if (t < 0.0) {
    EXPECT_LT(sampled, 0.0);
    ++outcome.passes;
    return;
  }
  ++outcome.meets;
  const double left = separation_at(q, t);
  EXPECT_GE(left, 0.0);
  EXPECT_LE(left, 1.0001 * q.tolerance);
  if (sampled >= 0.0) {
    EXPECT_LE(t, sampled);
  }
}

class EveryPairsImpact : public testing::TestWithParam<std::pair<Kind, Kind>> {};

std::vector<std::pair<Kind, Kind>> every_pair() {
  std::vector<std::pair<Kind, Kind>> pairs;
  for (const Kind a : kBounded) {
    for (const Kind b : kBounded) {
      if (a <= b) pairs.emplace_back(a, b);
    }
    pairs.emplace_back(a, Kind::half_space);
  }
  return pairs;
}

TEST_P(EveryPairsImpact, IsTheFirstOfFineSamples) {
  Random random(501);
  Outcome outcome;
  for (int i = 0; i < 12; ++i) {
    const Solid a = random_solid(random, GetParam().first),
                b = random_solid(random, GetParam().second);
    const bool ground = GetParam().second == Kind::half_space;
    const SE3 Ta(random.rotation(), ground ? Vec3{0, 0, 3} : 3.0 * random.direction());
    const SE3 Tb = ground ? SE3{} : SE3(random.rotation(), Vec3{});
    // More or less towards one another, half of them spinning at up to 150 rad/s, both moving.
    const double speed = random.uniform(1.0, 60.0), turning = i % 2 ? 150.0 : 5.0;
    const Vec3 v = random.in_cube(20.0);
    const Vec3 towards =
        (-speed / norm(Ta.position())) * Ta.position() + 0.3 * speed * random.direction();
    const Vec3 wa = random.uniform(0, turning) * random.direction();
    const Vec3 wb = ground ? Vec3{} : random.uniform(0, turning) * random.direction();
    const Vec3 vb = ground ? Vec3{} : v;
    const ImpactQuery q{moving(a.geometry, Ta, towards + vb, wa, random.in_cube(0.3)),
                        moving(b.geometry, Tb, vb, wb, random.in_cube(0.3)),
                        random.uniform(0.02, 0.2), 1e-6};
    check(q, outcome);
  }
  EXPECT_GE(outcome.meets, 2);
}

INSTANTIATE_TEST_SUITE_P(, EveryPairsImpact, testing::ValuesIn(every_pair()));

// A rod of 0.4 m length and 1 cm thickness, its ends at 30 m/s, flies at 25 m/s past or into a wall
// 2 mm thick. In a step of 1/60 s, it rotates by 2.5 rad.
TEST(TimeOfImpact, OfASpinningRodAndAThinWallIsThatOfFineSamples) {
  Random random(502);
  const Solid rod(Capsule{0.005, 0.2}), wall(Box{{0.001, 0.3, 0.3}});
  Outcome outcome;
  double worst = 0.0;
  for (int i = 0; i < samples(200); ++i) {
    const SE3 T(random.rotation(),
                Vec3{random.uniform(-0.4, -0.21), random.uniform(-0.5, 0.5), 0.1});
    const Vec3 w = 150.0 * random.direction();
    const Vec3 v{25.0 * random.uniform(-0.2, 1.0), random.uniform(-5, 5), random.uniform(-5, 5)};
    const ImpactQuery q{moving(rod.geometry, T, v, w), moving(wall.geometry, SE3{}, {}, {}),
                        i % 2 ? 1.0 / 60.0 : 0.001, 1e-6};
    check(q, outcome);
    const double t = impact_of(q), sampled = first_sample(q, 1e-6, 4000);
    if (t >= 0.0 && sampled >= 0.0) worst = std::max(worst, sampled - t);
  }
  EXPECT_GE(outcome.meets, samples(20));
  EXPECT_GE(outcome.passes, samples(20));
  // Samples are 4.2 us apart, so the first one after the impact is at most that late.
  EXPECT_LE(worst, 1.0 / 60.0 / 4000.0 + 1e-9);
}

// Both shapes move and rotate.
TEST(TimeOfImpact, IsTheSameSeenFromEitherShape) {
  Random random(503);
  int meets = 0;
  for (int i = 0; i < 200; ++i) {
    const Solid a = random_solid(random, kBounded[i % 6]),
                b = random_solid(random, kBounded[i / 6 % 6]);
    const SE3 Ta(random.rotation(), {1.6, 0, 0}), Tb(random.rotation(), Vec3{});
    const MovingShape ma =
        moving(a.geometry, Ta, {random.uniform(-30, 0), 0, 0}, 50.0 * random.direction());
    const MovingShape mb =
        moving(b.geometry, Tb, {random.uniform(0, 30), 0, 0}, 50.0 * random.direction());
    const double one = impact_of({ma, mb, 0.1, 1e-7}), other = impact_of({mb, ma, 0.1, 1e-7});
    ASSERT_EQ(one < 0.0, other < 0.0);
    if (one < 0.0) continue;
    ++meets;
    EXPECT_NEAR(one, other, 1e-7);
  }
  EXPECT_GE(meets, 50);
}

TEST(TimeOfImpact, IsTheClosedFormOfADoor) {
  // A door of 1 m by 2 cm rotates about its hinge at 2 rad/s towards a ball at 1 rad. The impact is
  // earlier by the angle of the ball's radius and half the door's thickness at its distance.
  const Solid door(Box{{0.5, 0.01, 1.0}}), ball(Sphere{0.05});
  const MovingShape a{&door.geometry, SE3(Vec3{0.5, 0, 0}), {{0, 0, 0}, {}, {0, 0, 2.0}}};
  const Vec3 at{0.8 * std::cos(1.0), 0.8 * std::sin(1.0), 0};
  const double expected = (1.0 - std::asin(0.06 / 0.8)) / 2.0;
  EXPECT_NEAR(impact_of({a, moving(ball.geometry, SE3(at), {}, {}), 1.0, 1e-9}), expected, 1e-9);
}

TEST(TimeOfImpact, LosesNothingFarFromTheOrigin) {
  const Solid a(Box{{0.5, 0.5, 0.5}}), b(Cylinder{0.3, 0.4});
  const Vec3 far{3e6, -2e6, 1e6};
  const auto at = [&](const Vec3& origin) {
    return impact_of({moving(a.geometry, SE3(origin), {40, 1, 2}, {3, 80, -20}),
                      moving(b.geometry, SE3(origin + Vec3{2, 0.25, 0}), {}, {0, 0, 9}), 0.1,
                      1e-7});
  };
  ASSERT_GT(at({}), 0.0);
  EXPECT_NEAR(at(far), at({}), 1e-9);
}

// A micrometre beside the wall and into it, parallel to the wall and spinning about its normal.
TEST(TimeOfImpact, GrazingMeetsOnlyWhatIsInTheWay) {
  const Solid rod(Capsule{0.01, 0.2}), wall(Box{{0.5, 0.5, 0.5}});
  for (const double gap : {1e-6, -1e-6}) {
    const SE3 T(Exp(Vec3{0, kPi / 2, 0}), {-1.0, 0, 0.51 + gap});
    const ImpactQuery q{moving(rod.geometry, T, {25, 0, 0}, {0, 0, 150}),
                        moving(wall.geometry, SE3{}, {}, {}), 0.08, 1e-8};
    EXPECT_EQ(impact_of(q) < 0.0, gap > 0.0) << gap;
  }
}

TEST(TimeOfImpact, OfWhatStandsStillIsNowOrNever) {
  const Solid a(Box{{0.5, 0.5, 0.5}}), b(Cone{0.3, 0.4});
  const MovingShape ma = moving(a.geometry, SE3{}, {}, {});
  EXPECT_EQ(impact_of({ma, moving(b.geometry, SE3(Vec3{0.6, 0, 0}), {}, {}), 1.0, 1e-6}), 0.0);
  EXPECT_LT(impact_of({ma, moving(b.geometry, SE3(Vec3{1.6, 0, 0}), {}, {}), 1.0, 1e-6}), 0.0);
}

// A target separation below zero, by a slop beyond the current overlap: a shape that moves in
// reaches it, one that moves out does not.
TEST(TimeOfImpact, CountsOverlapFromATargetBelowZero) {
  const Solid a(Box{{0.5, 0.5, 0.5}}), b(Cylinder{0.3, 0.5});
  const auto with = [&](double v) {
    return impact_of(
        {moving(a.geometry, SE3{}, {}, {}),
         moving(b.geometry, SE3(Vec3{0, 0, 0.9999}), {0, 0, v}, {0, 0, 50}), 0.1, 1e-6},
        -0.001);
  };
  EXPECT_NEAR(with(-1.0), 0.0009, 2e-6);
  EXPECT_LT(with(1.0), 0.0);
}

// Impacts after `latest` are not reported; earlier ones have the same bits.
TEST(TimeOfImpact, LatestChangesNoBit) {
  const Solid a(Capsule{0.1, 0.4}), b(Box{{0.2, 0.3, 0.4}});
  const ImpactQuery q{moving(a.geometry, SE3(Vec3{2, 0, 0}), {-20, 1, 0}, {0, 30, 5}),
                      moving(b.geometry, SE3{}, {}, {}), 0.2, 1e-7};
  const double t = impact_of(q);
  ASSERT_GT(t, 0.0);
  collide::PairCache fresh;
  EXPECT_EQ(time_of_impact(q, 0.0, fresh, t), t);
  fresh = {};
  EXPECT_LT(time_of_impact(q, 0.0, fresh, 0.99 * t), 0.0);
}

}  // namespace
}  // namespace vp::test
