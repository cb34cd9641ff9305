// A fast ball against fixed and rotating men. The check is independent of the engine's sweep: it
// intersects the chord of the ball's centre between two steps, in the man's frame, with each of his
// boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "random.h"
#include "rig.h"

namespace vp::test {
namespace {

// Whether the segment from a to b crosses the box |x| < h: the slab test.
bool crosses(const Vec3& a, const Vec3& b, const Vec3& h) {
  double enter = 0.0, leave = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double d = b[i] - a[i];
    if (d == 0.0) {
      if (std::fabs(a[i]) >= h[i]) return false;
      continue;
    }
    const double t0 = (-h[i] - a[i]) / d, t1 = (h[i] - a[i]) / d;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter < leave;
}

TEST(TunnellingCheck, SeesAChordThroughABoxAndNoOther) {
  const Vec3 h{0.01, 0.02, 0.03};
  EXPECT_TRUE(crosses({-1, 0, 0}, {1, 0, 0}, h));
  EXPECT_TRUE(crosses({-1, -1, -1}, {1, 1, 1}, h));
  EXPECT_FALSE(crosses({-1, 0.021, 0}, {1, 0.021, 0}, h));
  EXPECT_FALSE(crosses({-1, 0, 0}, {-0.02, 0, 0}, h));
}

// Half extents are reduced by this: chords of a curved path cut corners slightly, and a pressed
// ball penetrates by the slop.
constexpr double kShrink = 0.001;
constexpr double kTick = 0.001;

struct Outcome {
  int hits = 0, limited = 0, through = 0;
  double deepest = 0.0;  // largest penetration of the ball into a man at the end of a step
};

double distance_to(const Vec3& p, const ManPart& part) {
  const Vec3 d = p - part.centre;
  const Vec3 out{std::max(0.0, std::fabs(d.x) - part.half.x),
                 std::max(0.0, std::fabs(d.y) - part.half.y),
                 std::max(0.0, std::fabs(d.z) - part.half.z)};
  return norm(out);
}

// Shoots one ball at one man. The rod rotates and slides at random rates with a weak drive, or its
// targets are zero.
void shoot(Random& random, bool turning, Outcome& outcome) {
  World world;
  const Material material{0.3, random.uniform(0.0, 0.9), 0.0};
  const Rod rod = add_rod(world, 0.0, 0.09, 1, 0.0, material);
  const double angle = random.uniform(-kPi, kPi);
  const double rate = turning ? random.uniform(-150.0, 150.0) : 0.0;
  const double slide = turning ? random.uniform(-5.0, 5.0) : 0.0;
  must(world.set_joint_state(rod.articulation, 0, 0, 0.0, slide));
  must(world.set_joint_state(rod.articulation, 0, 1, angle, rate));
  must(world.set_drive(rod.articulation, 0, 0, {0.0, slide, 0.0, 1e4, 300.0}));
  must(world.set_drive(rod.articulation, 0, 1, {0.0, rate, 0.0, 10.0, 20.0}));

  // Aims at a random point of the man's current pose from 12 cm away; a rotating man may have moved
  // on.
  const ManPart& part = kMan[random.word() % 4];
  const double speed = random.uniform(20.0, 25.0);
  const SE3 pose = world.pose(rod.body);
  const Vec3 aim = pose * (part.centre + Vec3{random.uniform(-1, 1) * part.half.x,
                                              random.uniform(-1, 1) * part.half.y,
                                              random.uniform(-1, 1) * part.half.z});
  const Vec3 direction = random.direction();
  Vec3 start = aim - random.uniform(0.11, 0.14) * direction;
  // A start behind the head may be in the foot; the start then moves farther away.
  const auto in_the_way = [&](const ManPart& p) {
    return distance_to(inverse_times(pose, start), p) < kBallRadius + 0.001;
  };
  while (std::any_of(std::begin(kMan), std::end(kMan), in_the_way))
    start = start - 0.02 * direction;
  const BodyId ball = add_ball(world, start, speed * direction, material);

  Vec3 before = inverse_times(world.pose(rod.body), start);
  for (int tick = 0; tick < 14; ++tick) {
    const StepStatus status = must(world.step(kTick));
    outcome.limited += status.impact_limit;
    ASSERT_FALSE(status.non_finite);
    for (const ContactEvent& e : world.contact_events()) {
      outcome.hits += e.kind == ContactEvent::Kind::hit;
    }
    const Vec3 after = inverse_times(world.pose(rod.body), world.pose(ball).position());
    for (const ManPart& p : kMan) {
      const Vec3 half = p.half - Vec3{kShrink, kShrink, kShrink};
      outcome.through += crosses(before - p.centre, after - p.centre, half);
      outcome.deepest = std::max(outcome.deepest, kBallRadius - distance_to(after, p));
    }
    before = after;
  }
}

void run_shots(std::uint64_t seed, bool turning, int shots) {
  Random random(seed);
  Outcome outcome;
  for (int i = 0; i < shots && !::testing::Test::HasFatalFailure(); ++i) {
    shoot(random, turning, outcome);
    ASSERT_EQ(outcome.through, 0) << "shot " << i;
  }
  std::printf("shots %d, hits %d, steps at the impact limit %d, deepest %.3g mm\n", shots,
              outcome.hits, outcome.limited, 1e3 * outcome.deepest);
  // The shots are aimed: a run of misses would prove nothing.
  EXPECT_GT(outcome.hits, shots / 2);
  EXPECT_LT(outcome.deepest, 0.0005);
}

TEST(Tunnelling, NoBallPassesThroughAMan) {
  run_shots(11, false, SHOTS);
}

TEST(Tunnelling, NoBallPassesThroughATurningMan) {
  run_shots(12, true, SHOTS);
}

}  // namespace
}  // namespace vp::test
