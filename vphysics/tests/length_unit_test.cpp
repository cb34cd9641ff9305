// With a length unit set, bodies of all sizes behave alike.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "rig.h"

namespace vp::test {
namespace {

WorldDesc of_size(double length) {
  WorldDesc desc;
  desc.length_unit = length;
  return desc;
}

struct Tower {
  World world;
  double size;
  std::vector<BodyId> boxes;

  Tower(const WorldDesc& desc, double side, int count) : world(desc), size(side) {
    add_ground(world, {});
    for (int i = 0; i < count; ++i) {
      boxes.push_back(add_dynamic(world, {.shape = Box{{0.5 * size, 0.5 * size, 0.5 * size}},
                                          .pose = SE3(Vec3{0, 0, size * (i + 0.5)})}));
    }
  }
  // The displacement of the uppermost box, downwards and sideways, in box sizes.
  double sunk() const {
    const double start = static_cast<double>(boxes.size()) - 0.5;
    return start - world.pose(boxes.back()).position().z / size;
  }
  double drift() const {
    const Vec3 p = world.pose(boxes.back()).position();
    return std::hypot(p.x, p.y) / size;
  }
};

// Without a length unit, 1 cm at 60 Hz sinks by 0.25 of a cube, and 1 mm falls. With it: 0.03 and
// 0.1; 10 um at 1 kHz: 0.06.
TEST(LengthUnit, TowersOfSmallCubesStand) {
  struct Case {
    double size, rate, sunk;
  };
  for (const Case& c : {Case{0.1, 60, 0.02}, Case{0.01, 60, 0.05}, Case{0.001, 60, 0.15},
                        Case{0.01, 1000, 0.005}, Case{1e-5, 1000, 0.1}}) {
    SCOPED_TRACE(::testing::Message() << c.size << " m at " << c.rate << " Hz");
    Tower tower(of_size(c.size), c.size, 10);
    StepStatus status;
    for (int i = 0; i < 3 * c.rate; ++i) status |= must(tower.world.step(1.0 / c.rate));
    EXPECT_LT(tower.sunk(), c.sunk);
    EXPECT_LT(tower.drift(), 0.01);
    EXPECT_FALSE(status.position_error);
  }
}

// The same scene at a hundredth of the size and a tenth of the time.
TEST(LengthUnit, ScalesWithGravity) {
  Tower large({}, 1.0, 5), small(of_size(0.01), 0.01, 5);
  must(large.world.set_velocity(large.boxes.back(), {{}, {0.8, 0, 0}}));
  must(small.world.set_velocity(small.boxes.back(), {{}, {0.08, 0, 0}}));
  for (int i = 0; i < 240; ++i) {
    must(large.world.step(1.0 / 120));
    must(small.world.step(0.1 / 120));
  }
  EXPECT_EQ(large.world.counters().sub_steps, small.world.counters().sub_steps);
  const Vec3 a = large.world.pose(large.boxes.back()).position(),
             b = 100.0 * small.world.pose(small.boxes.back()).position();
  EXPECT_GT(a.x, 0.03);          // 0.8^2 / (2 0.5 g) = 0.065
  EXPECT_LT(norm(a - b), 1e-3);  // measured 2e-5
}

TEST(LengthUnit, ScalesWhatBouncesAndWhatSleeps) {
  for (const bool unit : {false, true}) {
    WorldDesc desc = of_size(unit ? 0.01 : 1.0);
    desc.sleep_after = 0.1;
    World world(desc);
    add_ground(world, {0.5, 0.5, 0.0});
    const BodyId ball = add_dynamic(
        world,
        {.shape = Sphere{0.005}, .material = {0.5, 0.5, 0.0}, .pose = SE3(Vec3{0, 0, 0.00506})});
    bool bounced = false;  // it falls by 0.06 mm, at 0.034 m/s
    for (int i = 0; i < 100; ++i) {
      must(world.step(0.001));
      bounced = bounced || world.velocity(ball).v.z > 0.01;
    }
    EXPECT_EQ(bounced, unit);
  }
}

TEST(LengthUnit, IsRefusedWhereItIsNoSize) {
  for (const double bad : {0.0, -1.0, 1e-7, 1e7, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(World::create(of_size(bad)).has_value()) << bad;
  }
  EXPECT_TRUE(World::create(of_size(1e-6)).has_value());
}

}  // namespace
}  // namespace vp::test
