// Each begin event is followed by one end event, also when bodies are moved, destroyed or restored
// in between. Events of sensors on continuous bodies.
#include <gtest/gtest.h>

#include <vector>

#include "rig.h"

namespace vp::test {
namespace {

using K = ContactEvent::Kind;

BodyId add_sensor(World& world, BodyId body, const Shape& shape, std::uint64_t user_data = 7) {
  ColliderDesc desc;
  desc.shape = shape;
  desc.sensor = true;
  desc.user_data = user_data;
  must(world.add_collider(body, desc));
  return body;
}
BodyId fixed_body(World& world, const Vec3& at = {}) {
  BodyDesc desc;
  desc.motion = Motion::fixed;
  desc.T_world_body = SE3(at);
  return must(world.create_body(desc));
}
// The sensor events of the given number of steps.
std::vector<K> sensor_events(World& world, int steps) {
  std::vector<K> out;
  for (int i = 0; i < steps; ++i) {
    must(world.step(0.001));
    for (const ContactEvent& e : world.contact_events()) {
      if (e.sensor) out.push_back(e.kind);
    }
  }
  return out;
}
const std::vector<K> kOnce = {K::begin, K::end};

const Shape kSensors[] = {Box{{0.05, 0.05, 0.05}}, Capsule{0.05, 0.02}, Sphere{0.06}};

TEST(Sensor, OfAnyShapeOnAContinuousBodySeesFixedAndDynamicBodies) {
  for (const Shape& shape : kSensors) {
    for (const bool fixed : {true, false}) {
      World world({.gravity = {}});
      const Vec3 at{0.3, 0.055, 0};  // within the sensor, beyond the ball
      if (fixed) {
        add_fixed(world, Sphere{0.02}, {}, SE3(at));
      } else {
        add_dynamic(world, {.shape = Sphere{0.02}, .pose = SE3(at)});
      }
      add_sensor(world, add_ball(world, {}, {2, 0, 0}, {}), shape);
      EXPECT_EQ(sensor_events(world, 400), kOnce) << shape.index() << fixed;
    }
  }
}

// Each sensor detects the other body's ball, but no sensor. Both orders of creation.
TEST(Sensor, OfAnyShapeOnAContinuousBodySeesAnotherContinuousBody) {
  for (const Shape& shape : kSensors) {
    for (const bool sensor_first : {true, false}) {
      World world({.gravity = {}});
      const Vec3 apart{0, 0.05, 0};
      const BodyId a = add_ball(world, {}, {2, 0, 0}, {});
      const BodyId b = add_ball(world, Vec3{0.3, 0, 0} + apart, {-2, 0, 0}, {});
      add_sensor(world, sensor_first ? a : b, shape);
      EXPECT_EQ(sensor_events(world, 200), kOnce) << shape.index() << sensor_first;
    }
  }
}

// A ball moves 30 mm a step through a sensor of 2 mm on the slower of the two bodies.
TEST(Sensor, OnAContinuousBodyMissesNoFastBall) {
  for (const bool sensor_first : {true, false}) {
    World world({.gravity = {}});
    const auto add_carrier = [&] {
      BodyDesc desc;
      desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
      desc.continuous = true;
      add_sensor(world, must(world.create_body(desc)), Box{{0.001, 0.1, 0.1}});
    };
    if (sensor_first) add_carrier();
    add_ball(world, {-0.1 - kBallRadius, 0, 0}, {60, 0, 0}, {});
    if (!sensor_first) add_carrier();
    EXPECT_EQ(sensor_events(world, 20), kOnce) << sensor_first;
  }
}

struct Touching {
  World world;
  BodyId ground, box;
};
Touching make_touching() {
  Touching t;
  t.ground = fixed_body(t.world);
  ColliderDesc floor;
  floor.shape = HalfSpace{};
  floor.user_data = 11;
  must(t.world.add_collider(t.ground, floor));
  t.box = add_dynamic(t.world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.1})});
  for (int i = 0; i < 20; ++i) must(t.world.step(0.001));
  return t;
}

TEST(Events, EndAtTheStepAfterABodyIsDestroyed) {
  for (const bool both : {false, true}) {
    Touching t = make_touching();
    must(t.world.destroy_body(t.box));
    if (both) must(t.world.destroy_body(t.ground));
    add_dynamic(t.world, {.pose = SE3(Vec3{0, 0, 9})});  // reuses a free slot
    must(t.world.step(0.001));
    ASSERT_EQ(t.world.contact_events().size(), 1u);
    const ContactEvent e = t.world.contact_events()[0];
    EXPECT_EQ(e.kind, K::end);
    EXPECT_FALSE(e.sensor);
    EXPECT_EQ(e.a, (ColliderId{1, 1}));
    EXPECT_EQ(e.b, (ColliderId{2, 1}));
    EXPECT_EQ(e.user_data_a, both ? 0u : 11u);
    EXPECT_EQ(e.user_data_b, 0u);
    EXPECT_EQ(e.time, 0.0);
    must(t.world.step(0.001));
    EXPECT_TRUE(t.world.contact_events().empty());
  }
}

TEST(Events, OfADestroyedSensorEndToo) {
  World world({.gravity = {}});
  const BodyId goal = add_sensor(world, fixed_body(world), Box{{0.1, 0.1, 0.1}});
  add_ball(world, {}, {}, {});
  ASSERT_EQ(sensor_events(world, 5), (std::vector<K>{K::begin}));
  must(world.destroy_body(goal));
  EXPECT_EQ(sensor_events(world, 5), (std::vector<K>{K::end}));
}

TEST(Events, OfTheDestroyedThatTouchedNothingAreNone) {
  Touching t = make_touching();
  must(t.world.set_pose(t.box, SE3(Vec3{0, 0, 5})));
  must(t.world.step(0.001));
  must(t.world.destroy_body(t.box));
  must(t.world.step(0.001));
  EXPECT_TRUE(t.world.contact_events().empty());
}

// The end event is part of a snapshot taken between the call and the step that reports it.
TEST(Events, OfADestroyedBodySurviveASnapshot) {
  Touching t = make_touching();
  must(t.world.destroy_body(t.box));
  std::vector<std::byte> bytes;
  t.world.snapshot(bytes);
  for (int round = 0; round < 2; ++round) {
    must(t.world.step(0.001));
    EXPECT_EQ(t.world.contact_events().size(), 1u) << round;
    must(t.world.restore(bytes));
    EXPECT_TRUE(t.world.contact_events().empty()) << "those of a step that was undone";
  }
  Touching other = make_touching();
  must(other.world.destroy_body(other.box));
  must(other.world.step(0.001));
  must(other.world.restore(bytes));
  must(other.world.step(0.001));
  must(t.world.step(0.001));
  EXPECT_EQ(other.world.contact_events().size(), 1u);
  EXPECT_EQ(other.world.state_hash(), t.world.state_hash());
}

TEST(Events, EndAndBeginWhenABodyIsPutElsewhere) {
  Touching t = make_touching();
  const auto after = [&](const Vec3& at) {
    must(t.world.set_pose(t.box, SE3(at)));
    must(t.world.step(0.001));
    std::vector<K> out;
    for (const ContactEvent& e : t.world.contact_events()) out.push_back(e.kind);
    return out;
  };
  EXPECT_EQ(after({0, 0, 5}), (std::vector<K>{K::end}));
  EXPECT_EQ(after({3, 0, 0.1}), (std::vector<K>{K::begin}));
  EXPECT_EQ(after({-3, 0, 0.1}), std::vector<K>{}) << "the same ground";
}

TEST(Events, OfASensorTellOfABodyThatIsPutIntoItUnlessBothAreFixed) {
  for (const Motion motion : {Motion::fixed, Motion::kinematic, Motion::dynamic}) {
    const bool seen = motion != Motion::fixed;
    World world({.gravity = {}});
    const BodyId goal = add_sensor(world, fixed_body(world), Box{{0.1, 0.1, 0.1}});
    BodyDesc desc;
    desc.motion = motion;
    desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
    desc.T_world_body = SE3(Vec3{5, 0, 0});
    const BodyId body = must(world.create_body(desc));
    ColliderDesc ball;
    ball.shape = Sphere{0.1};
    must(world.add_collider(body, ball));
    EXPECT_EQ(sensor_events(world, 3), std::vector<K>{});
    must(world.set_pose(body, {}));
    EXPECT_EQ(sensor_events(world, 3), std::vector<K>(seen ? 1 : 0, K::begin))
        << static_cast<int>(motion);
    must(world.set_pose(goal, SE3(Vec3{0, 5, 0})));
    EXPECT_EQ(sensor_events(world, 3), std::vector<K>(seen ? 1 : 0, K::end))
        << static_cast<int>(motion);
  }
}

}  // namespace
}  // namespace vp::test
