// A driven man presses a ball against a rigid body.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "rig.h"

namespace vp::test {
namespace {

constexpr double kTick = 0.001;
const Material kWood{0.3, 0.6, 0.0};
const Material kPlastic{0.4, 0.5, 0.0005};

BodyId add_field(World& world) {
  return add_ground(world, kWood);
}

// The man's foot presses the ball against a wall behind it, at negative x.
TEST(Pinch, ADrivenRodIsStoppedByABallAtAWall) {
  World world;
  add_field(world);
  add_fixed(world, Box{{0.02, 0.3, 0.05}}, kWood, SE3(Vec3{-0.08, 0, 0.05}));
  const Rod rod = add_rod(world, 0.0, 0.09, 1, 0.0, kPlastic);
  const double wall = -0.06;
  const BodyId ball =
      add_ball(world, {wall + kBallRadius + 2e-4, 0.0, kBallRadius + 5e-5}, {}, kPlastic);
  // A positive angle swings the foot towards -x, into the ball.
  must(world.set_drive(rod.articulation, 0, 1, {1.5, 0.0, 200.0, 1.0, 10.0}));
  double deepest = 0.0, held = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    const StepStatus status = must(world.step(kTick));
    held += status.time_lost;
    const Vec3 p = world.pose(ball).position();
    deepest = std::max(deepest, wall + kBallRadius - p.x);
    deepest = std::max(deepest, kBallRadius - p.z);
    ASSERT_GT(p.x, wall) << "pushed into the wall at tick " << tick;
    ASSERT_GT(p.z, 0.0) << "pushed into the field at tick " << tick;
  }
  std::printf("deepest %.3g mm, held %.3g s of 3, angle %.3f\n", 1e3 * deepest, held,
              world.joint_position(rod.articulation, 0, 1));
  EXPECT_LT(deepest, 0.0005);
  EXPECT_LT(std::fabs(world.joint_velocity(rod.articulation, 0, 1)), 0.2);
  EXPECT_LT(world.joint_position(rod.articulation, 0, 1), 0.6);  // the ball is in the way
}

// The load goes back and forth between foot and wall, half a percent smaller each time. Iterations
// that stop early leave an impulse that looks like an impact. Without acceleration the foot still
// moves at 0.1 rad/s after 60 ms, with it at 1e-6.
TEST(Pinch, AFootThatPressesABallAtAWallComesToRest) {
  World world;
  add_field(world);
  add_fixed(world, Box{{0.02, 0.3, 0.05}}, kWood, SE3(Vec3{-0.08, 0, 0.05}));
  const Rod rod = add_rod(world, 0.0, 0.09, 1, 0.0, kPlastic);
  (void)add_ball(world, {-0.06 + kBallRadius + 2e-4, 0.0, kBallRadius + 5e-5}, {}, kPlastic);
  must(world.set_drive(rod.articulation, 0, 1, {1.5, 0.0, 200.0, 1.0, 10.0}));
  double fastest = 0.0;
  for (int tick = 0; tick < 100; ++tick) {
    must(world.step(kTick));
    const double speed = std::fabs(world.joint_velocity(rod.articulation, 0, 1));
    if (tick >= 60) fastest = std::max(fastest, speed);
  }
  std::printf("after 60 ms at most %.2g rad/s\n", fastest);
  EXPECT_LT(fastest, 1e-3);
}

// The sole comes down on the ball. At small angles, the torque gives a force of hundreds of
// newtons.
TEST(Pinch, ABallUnderAFootStaysAboveTheField) {
  for (const double target : {-0.3, -0.1, 0.0, 0.1, 0.3}) {
    World world;
    add_field(world);
    // The rod is so low that the foot leaves 30 mm for a ball of 34.5 mm.
    const Rod rod = add_rod(world, 0.0, 0.076 + 0.030, 1, 0.0, kPlastic);
    must(world.set_joint_state(rod.articulation, 0, 1, 1.2, 0.0));
    const BodyId ball = add_ball(world, {0.0, 0.0, kBallRadius}, {}, kPlastic);
    must(world.set_drive(rod.articulation, 0, 1, {target, 0.0, 200.0, 1.0, 20.0}));
    double deepest = 0.0, held = 0.0;
    for (int tick = 0; tick < 1500; ++tick) {
      held += must(world.step(kTick)).time_lost;
      const Vec3 p = world.pose(ball).position();
      deepest = std::max(deepest, kBallRadius - p.z);
      ASSERT_GT(p.z, 0.5 * kBallRadius) << "tick " << tick;
      ASSERT_TRUE(std::isfinite(p.x));
    }
    std::printf("target %.1f: deepest %.3g mm, held %.3g s\n", target, 1e3 * deepest, held);
    EXPECT_LT(deepest, 0.001);
  }
}

TEST(Pinch, ABallInACornerComesToRest) {
  World world;
  add_field(world);
  add_fixed(world, Box{{0.1, 1, 0.1}}, kWood, SE3(Vec3{-0.1, 0, 0.1}));
  add_fixed(world, Box{{1, 0.1, 0.1}}, kWood, SE3(Vec3{0, -0.1, 0.1}));
  const BodyId ball = add_ball(world, {0.2, 0.2, 0.05}, {-15, -15.5, -5}, kPlastic);
  int impacts = 0;
  for (int tick = 0; tick < 8000; ++tick) {
    EXPECT_FALSE(must(world.step(kTick)).impact_limit);
    impacts += static_cast<int>(world.counters().impacts);
    const Vec3 p = world.pose(ball).position();
    ASSERT_GT(p.x, kBallRadius - 5e-4);
    ASSERT_GT(p.y, kBallRadius - 5e-4);
    ASSERT_GT(p.z, kBallRadius - 5e-4);
    if (p.x > 0.8 || p.y > 0.8) return;  // bounced out to the open side
  }
  EXPECT_GT(impacts, 3);
}

// Ever faster bounces end in rest at the threshold.
TEST(Pinch, ZenoBouncingComesToRest) {
  World world;
  add_ground(world, {0.5, 0.9, 0.0});
  const BodyId ball = add_ball(world, {0, 0, 0.05}, {}, {0.5, 0.9, 0.0});
  for (int tick = 0; tick < 6000; ++tick) EXPECT_FALSE(must(world.step(kTick)).impact_limit);
  EXPECT_LT(std::fabs(world.velocity(ball).v.z), 1e-6);
  EXPECT_NEAR(world.pose(ball).position().z, kBallRadius, 1.1e-4);
}

}  // namespace
}  // namespace vp::test
