// Impacts of continuous bodies affect the bodies in contact, and no others.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "random.h"
#include "rig.h"

namespace vp::test {
namespace {

constexpr double kStep = 0.001, kRadius = 0.02;
constexpr Material kElastic{0.0, 1.0};

BodyId add_swept(World& world, const Shape& shape, const Vec3& at, const Vec3& velocity,
                 const Vec3& rate = {}, const Material& material = kElastic) {
  Part part;
  part.shape = shape;
  part.material = material;
  part.continuous = true;
  part.pose = SE3(at);
  part.velocity = {rate, velocity};
  return add_dynamic(world, part);
}

// A ball and tumbling boxes, in flight.
std::vector<BodyId> add_scene_to_look_at(World& world) {
  const Box box{{0.04, 0.03, 0.02}};
  return {add_swept(world, Sphere{kRadius}, {0, 0, kRadius}, {0.3, 0, 2}, {1, 2, 3}),
          add_swept(world, box, {-0.5, 0.4, 0.02}, {0.9, 0, 1}, {-30, 20, 5}),
          add_swept(world, box, {0.0, 0.8, 0.15}, {0, 0, 5}, {3, 2, 1})};
}

TEST(Impacts, LeaveNoTraceInWhatMeetsNothing) {
  World alone, beside;
  const auto expected = add_scene_to_look_at(alone), bodies = add_scene_to_look_at(beside);
  // Two walls. Balls fly between them and collide several times a step.
  Random random(1201);
  for (const double y : {-0.1, 0.1}) {
    add_fixed(beside, Box{{1.0, 0.02, 1.0}}, kElastic, SE3(Vec3{10.0, y, 0}));
  }
  for (int i = 0; i < 12; ++i) {
    add_swept(beside, Sphere{kRadius}, {10.0 + 0.05 * i, 0, 0.1 * (i % 3)},
              {random.uniform(-9, 9), random.uniform(-90, 90), 0});
  }
  std::uint64_t impacts = 0;
  for (int k = 0; k < 900; ++k) {
    must(alone.step(kStep));
    must(beside.step(kStep));
    ASSERT_EQ(alone.counters().impacts, 0u);
    impacts += beside.counters().impacts;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const SE3 T = alone.pose(expected[i]), there = beside.pose(bodies[i]);
      ASSERT_EQ(T.position(), there.position()) << "step " << k << ", body " << i;
      const Vec3 x{1, 2, 3};
      ASSERT_EQ(T.rotation() * x, there.rotation() * x);
    }
  }
  EXPECT_GT(impacts, 500u);  // measured 597
}

// The first ball hits the second, that hits the third, and so on, all within a step. Each moves on
// with the first ball's velocity from its own position, and the last gets as far as the first would
// have.
TEST(Impacts, RunThroughARowWithinAStep) {
  World world({.gravity = {}});
  constexpr int kBalls = 8;
  constexpr double kGap = 0.001, kSpeed = 20.0;
  std::vector<BodyId> balls;
  for (int i = 0; i < kBalls; ++i) {
    balls.push_back(add_swept(world, Sphere{kRadius}, {i * (2 * kRadius + kGap), 0, 0},
                              i == 0 ? Vec3{kSpeed, 0, 0} : Vec3{}));
  }
  // One ball flies past the row without touching it.
  const BodyId beside = add_swept(world, Sphere{kRadius}, {0, 0.0402, 0}, {15.0, 0, 0});
  must(world.step(kStep));
  EXPECT_EQ(world.counters().impacts, static_cast<std::uint32_t>(kBalls - 1));
  for (int i = 0; i + 1 < kBalls; ++i) {
    EXPECT_NEAR(world.velocity(balls[static_cast<std::size_t>(i)]).v.x, 0.0, 1e-9);
    EXPECT_NEAR(world.pose(balls[static_cast<std::size_t>(i)]).position().x,
                i * (2 * kRadius + kGap) + kGap, 1e-4);  // the slop
  }
  const double last = (kBalls - 1) * (2 * kRadius + kGap) + kSpeed * kStep - (kBalls - 1) * kGap;
  EXPECT_NEAR(world.velocity(balls.back()).v.x, kSpeed, 1e-9);
  EXPECT_NEAR(world.pose(balls.back()).position().x, last, 7e-4);
  EXPECT_NEAR(world.pose(beside).position().x, 0.015, 1e-12);
}

TEST(Impacts, OfManyAtOnceAreOne) {
  World world;
  add_ground(world, kElastic);
  std::vector<BodyId> balls;
  for (int i = 0; i < 100; ++i) {
    balls.push_back(
        add_swept(world, Sphere{kRadius}, {0.1 * (i % 10), 0.1 * (i / 10), 0.3}, {0, 0, -1}));
  }
  std::uint32_t impacts = 0;
  for (int k = 0; k < 1000; ++k) {
    ASSERT_FALSE(must(world.step(kStep)).impact_limit);
    impacts += world.counters().impacts;
    for (const BodyId ball : balls)
      ASSERT_EQ(world.pose(ball).position().z, world.pose(balls[0]).position().z);
  }
  EXPECT_GT(impacts, 0u);
  EXPECT_LT(impacts, 10u);
}

struct Gas {
  World world{{.gravity = {}}};
  std::vector<BodyId> balls;

  explicit Gas(int per_side) {
    Random random(1202);
    constexpr double kHalf = 0.2;
    add_walls(world, kHalf, 0.1, kElastic);
    const double pitch = 2.0 * kHalf / per_side;
    for (int i = 0; i < per_side * per_side * per_side; ++i) {
      const auto along = [&](int k) { return pitch * (k % per_side + 0.5) - kHalf; };
      balls.push_back(add_swept(world, Sphere{0.01},
                                {along(i), along(i / per_side), along(i / per_side / per_side)},
                                4.0 * random.direction()));
    }
  }
  double energy() const {
    double sum = 0.0;
    for (const BodyId ball : balls) {
      const Vec3 v = world.velocity(ball).v;
      sum += dot(v, v);
    }
    return sum;
  }
};

TEST(Impacts, OfAGasKeepItsEnergyAndItsBalls) {
  Gas gas(6);
  const double before = gas.energy();
  double nearest = 1.0;
  for (int k = 0; k < 300; ++k) {
    ASSERT_FALSE(must(gas.world.step(kStep)).impact_limit);
    for (std::size_t i = 0; i < gas.balls.size(); ++i) {
      const Vec3 x = gas.world.pose(gas.balls[i]).position();
      for (int axis = 0; axis < 3; ++axis) ASSERT_LT(std::fabs(x[axis]), 0.2 - 0.01 + 2e-4);
      for (std::size_t j = 0; j < i; ++j) {
        nearest = std::min(nearest, norm(gas.world.pose(gas.balls[j]).position() - x));
      }
    }
  }
  EXPECT_GT(nearest, 0.02 - 2e-4);
  EXPECT_NEAR(gas.energy() / before, 1.0, 1e-4);
}

TEST(Impacts, GoOnAsBeforeFromASnapshot) {
  Gas gas(5), other(5);
  for (int k = 0; k < 60; ++k) must(gas.world.step(kStep));
  std::vector<std::byte> bytes;
  gas.world.snapshot(bytes);
  must(other.world.restore(bytes));
  for (int k = 0; k < 60; ++k) {
    must(gas.world.step(kStep));
    must(other.world.step(kStep));
    ASSERT_EQ(gas.world.state_hash(), other.world.state_hash()) << "step " << k;
  }
}

// Balls fly after one another at the same velocity. At the limit of impacts the first stops before
// a wall, and so do those behind it that would pass through it.
TEST(Impacts, AtTheirLimitStopWhatFollowsAStoppedBody) {
  for (const double gap : {0.001, 0.005, 0.02}) {
    WorldDesc desc;
    desc.gravity = {};
    desc.max_impacts_per_step = 1;
    World world(desc);
    constexpr double kSpeed = 100.0;
    add_fixed(world, Box{{0.002, 0.5, 0.5}}, kElastic, SE3(Vec3{0.002, 0, 0}));
    // Two that meet at the start of the step and use up its impacts.
    add_swept(world, Sphere{kRadius}, {0, 3, 0}, {kSpeed, 0, 0});
    add_swept(world, Sphere{kRadius}, {2 * kRadius + 2e-4, 3, 0}, {});
    std::vector<BodyId> balls;
    for (int i = 0; i < 8; ++i) {
      balls.push_back(add_swept(world, Sphere{kRadius},
                                {-kRadius - 0.5 * kSpeed * kStep - i * (2 * kRadius + gap), 0, 0},
                                {kSpeed, 0, 0}));
    }
    int limited = 0;
    for (int k = 0; k < 30; ++k) {
      limited += must(world.step(kStep)).impact_limit;
      for (std::size_t i = 0; i < balls.size(); ++i) {
        const double next = i == 0 ? kRadius : world.pose(balls[i - 1]).position().x;
        ASSERT_LT(world.pose(balls[i]).position().x, next - 2 * kRadius + 2e-4)
            << "step " << k << ", ball " << i << ", gap " << gap;
      }
    }
    EXPECT_GT(limited, 0);
  }
}

// A sensor event has the time and point at which a body enters it, although other bodies collide in
// the same step.
TEST(Impacts, LeaveASensorItsTime) {
  World world({.gravity = {}});
  ColliderDesc gate;
  gate.shape = Box{{0.001, 0.1, 0.1}};
  gate.sensor = true;
  BodyDesc fixed;
  fixed.motion = Motion::fixed;
  must(world.add_collider(must(world.create_body(fixed)), gate));
  add_swept(world, Sphere{kRadius}, {-0.031, 0, 0}, {20.0, 0, 0});
  for (int i = 0; i < 4; ++i) {
    add_swept(world, Sphere{kRadius}, {1.0, 0.041 + 0.0412 * i, 0}, {0, i == 0 ? 10.0 : 0.0, 0});
  }
  must(world.step(kStep));
  EXPECT_GE(world.counters().impacts, 3u);
  std::vector<ContactEvent> at_gate;
  for (const ContactEvent& e : world.contact_events()) {
    if (e.point.x < 0.5) at_gate.push_back(e);
  }
  ASSERT_EQ(at_gate.size(), 1u);
  EXPECT_NEAR(at_gate[0].time, 0.0005, 1e-6);
  EXPECT_NEAR(at_gate[0].point.x, -0.021, 2e-5);
}

}  // namespace
}  // namespace vp::test
