// The world's calls: rejected arguments, reports, query results.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "rig.h"
#include "vphysics/assert.h"

namespace vp::test {
namespace {

constexpr double kBad[] = {kNaN, kInfinity, -kInfinity, 1e300};

// Expects an error with a message, and no change.
template <class Call>
void expect_refused(World& world, Call call, Errc code = Errc::invalid_argument) {
  const std::uint64_t before = world.state_hash();
  const auto result = call();
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, code);
  EXPECT_GT(result.error().message.size(), 15u);
  EXPECT_EQ(world.state_hash(), before);
}

TEST(CreateBody, RefusesWhatIsNoBody) {
  World world;
  BodyDesc good;
  good.inertia = Inertia(1.0, Vec3{1, 1, 1});
  ASSERT_TRUE(world.create_body(good));
  const auto refused = [&](auto change) {
    BodyDesc desc = good;
    change(desc);
    expect_refused(world, [&] { return world.create_body(desc); });
  };
  for (const double bad : kBad) {
    refused([&](BodyDesc& d) { d.T_world_body = SE3(Vec3{0, bad, 0}); });
    refused([&](BodyDesc& d) { d.velocity.w.x = bad; });
    refused([&](BodyDesc& d) { d.inertia = Inertia(bad, Vec3{1, 1, 1}); });
    refused([&](BodyDesc& d) { d.inertia = Inertia(1.0, Vec3{1, bad, 1}); });
    refused([&](BodyDesc& d) { d.linear_damping = bad; });
  }
  refused([](BodyDesc& d) { d.T_world_body = SE3({{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}); });
  refused([](BodyDesc& d) { d.T_world_body = SE3({{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}); });
  refused([](BodyDesc& d) { d.inertia = Inertia(0.0, Vec3{1, 1, 1}); });
  refused([](BodyDesc& d) { d.inertia = Inertia(1.0, Vec3{}); });
  refused([](BodyDesc& d) { d.inertia = Inertia(1.0, Vec3{1, -1, 1}); });
  refused([](BodyDesc& d) { d.angular_damping = -1.0; });
}

TEST(AddCollider, RefusesWhatIsNoShape) {
  World world;
  const BodyId body = add_dynamic(world, {});
  const auto refused = [&](auto change, Errc code = Errc::invalid_argument) {
    ColliderDesc desc;
    change(desc);
    expect_refused(
        world, [&] { return world.add_collider(body, desc); }, code);
  };
  for (const double bad : {kNaN, kInfinity, -1.0, 0.0}) {
    refused([&](ColliderDesc& d) { d.shape = Sphere{bad}; });
    refused([&](ColliderDesc& d) { d.shape = Box{{1, bad, 1}}; });
    refused([&](ColliderDesc& d) { d.shape = Capsule{bad, 1}; });
    refused([&](ColliderDesc& d) { d.shape = Cylinder{bad, 1}; });
    refused([&](ColliderDesc& d) { d.shape = Cylinder{1, bad}; });
    refused([&](ColliderDesc& d) { d.shape = Cone{bad, 1}; });
    refused([&](ColliderDesc& d) { d.shape = Cone{1, bad}; });
    refused([&](ColliderDesc& d) { d.density = bad; });
  }
  refused([&](ColliderDesc& d) { d.shape = Capsule{1, -1}; });
  refused([&](ColliderDesc& d) { d.shape = HalfSpace{}; });
  refused([&](ColliderDesc& d) { d.material.friction = -1; });
  refused([&](ColliderDesc& d) { d.material.restitution = 1.5; });
  refused([&](ColliderDesc& d) { d.material.restitution = kNaN; });
  refused([&](ColliderDesc& d) { d.material.rolling_friction = kNaN; });
  refused([&](ColliderDesc& d) { d.material.spinning_friction = -1; });
  refused([&](ColliderDesc& d) { d.surface_velocity.y = kInfinity; });
  refused([&](ColliderDesc& d) { d.T_body_shape = SE3(Vec3{kNaN, 0, 0}); });
}

TEST(CreateArticulation, RefusesWhatItCannotSimulate) {
  World world;
  const LinkSpec link = rod_link(0, 0);
  const auto refused = [&](auto change, Errc code = Errc::invalid_argument) {
    LinkSpec bad = link;
    change(bad);
    const ArticulationDesc desc{model_of({bad})};
    expect_refused(
        world, [&] { return world.create_articulation(desc); }, code);
  };
  // No inertia about its axis.
  refused([](LinkSpec& l) { l.inertia = Inertia(1.0, Vec3{1, 1, 0}); }, Errc::singular);
  refused([](LinkSpec& l) { l.inertia = Inertia(1.0, Vec3{}); }, Errc::singular);
  refused([](LinkSpec& l) { l.inertia = Inertia(1e10, Vec3{1, 1, 1}); });
  refused([](LinkSpec& l) { l.armature = 1e10; });
  refused([](LinkSpec& l) { l.T_parent_joint = SE3(Vec3{1e10, 0, 0}); });
  refused([](LinkSpec& l) { l.forces[0].rest = 1e10; });
  refused([](LinkSpec& l) { l.forces[1].lower = 1e10; });
  LinkSpec floating = link;
  floating.joint = FreeJoint{};
  floating.forces.clear();
  const ArticulationId free = must(world.create_articulation({model_of({floating})}));
  expect_refused(world, [&] { return world.set_drive(free, 0, 0, {0, 0, 1, 1, 1}); });
  must(world.set_drive(free, 0, 0, {0, 0, 0, 1, 1}));
  expect_refused(world, [&] { return world.set_joint_state(free, 0, 0, 0, 0); });
  const std::vector<double> rest(6);
  const auto states_refused = [&](const std::vector<double>& q, const std::vector<double>& v) {
    expect_refused(world, [&] { return world.set_joint_states(free, q, v); });
  };
  states_refused({0, 0, 0, 0, 0, 0}, rest);
  states_refused({0, 0, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0});
  states_refused({0, 0, 0, 0, 0, 0, 1.1}, rest);
  states_refused({0, 0, 0, 0, 0, 0, 0}, rest);
  states_refused({kNaN, 0, 0, 0, 0, 0, 1}, rest);
  states_refused({0, 0, 0, 0, 0, 0, 1}, {0, 0, kInfinity, 0, 0, 0});
  must(world.set_joint_states(free, std::vector<double>{1, 2, 3, 0, 0, 1, 0}, rest));
  expect_refused(world, [&] { return world.set_joint_states({}, rest, rest); });
  const ArticulationId id = must(world.create_articulation(rod_desc(0, 0)));
  expect_refused(world, [&] { return world.set_drive(id, 0, 2, {}); });
  expect_refused(world, [&] { return world.set_drive(id, 1, 0, {}); });
  expect_refused(world, [&] { return world.set_drive({}, 0, 0, {}); });
  expect_refused(world, [&] { return world.set_drive(id, 0, 0, {kNaN, 0, 1, 1, 1}); });
  expect_refused(world, [&] { return world.set_drive(id, 0, 0, {0, 0, -1, 1, 1}); });
  expect_refused(world,
                 [&] { return world.set_joint_state(id, 0, 0, 0.5, 0); });  // beyond its limit
  expect_refused(world, [&] { return world.set_joint_state(id, 0, 1, 0, kInfinity); });
  const BodyId body = world.link_body(id, 0);
  expect_refused(world, [&] { return world.set_pose(body, {}); });
  expect_refused(world, [&] { return world.set_velocity(body, {}); });
  expect_refused(world, [&] { return world.destroy_body(body); });
  EXPECT_FALSE(world.link_body(id, 1));
}

TEST(CreateArticulation, TakesPointMassesAndThinRods) {
  World world;
  LinkSpec link;
  link.joint = PrismaticJoint{};
  for (const Inertia& J : {Inertia(1.0, Vec3{}), Inertia(1.0, Vec3{1, 1, 0}),
                           Inertia(0.1, Vec3{}).Xform(SE3(Vec3{0.3, 0.7, 0.1})),
                           Inertia(0.1, Vec3{1, 1, 0}).Xform(SE3(Vec3{30, 70, 10}))}) {
    link.inertia = J;
    EXPECT_TRUE(world.create_articulation({model_of({link})}));
  }
}

TEST(Step, RefusesATimeThatIsNone) {
  World world;
  for (const double dt : {0.0, -0.001, 0.11, kNaN, kInfinity, 0.9e-7, 1e-12, 1e-30, 1e-300}) {
    expect_refused(world, [&] { return world.step(dt); });
  }
}

TEST(World, MayBeAssignedToWhenMovedFrom) {
  World first;
  const BodyId body = add_dynamic(first, {});
  World second = std::move(first);
  EXPECT_TRUE(second.contains(body));
  first = World();
  EXPECT_FALSE(first.contains(body));
  must(first.step(0.001));
}

TEST(Ids, OfTheDestroyedAreStaleForever) {
  World world;
  const BodyId first = add_dynamic(world, {});
  must(world.destroy_body(first));
  const BodyId second = add_dynamic(world, {});
  EXPECT_EQ(first.index, second.index);
  EXPECT_FALSE(world.contains(first));
  EXPECT_TRUE(world.contains(second));
  EXPECT_FALSE(world.contains(BodyId{}));
  EXPECT_FALSE(world.contains(BodyId{77, 1}));
  expect_refused(world, [&] { return world.destroy_body(first); });
  expect_refused(world, [&] { return world.set_pose(first, {}); });
  expect_refused(world, [&] { return world.add_collider(first, {}); });
  expect_refused(world, [&] { return world.apply_impulse(first, {1, 0, 0}, {}); });
  expect_refused(world, [&] { return world.apply_impulse(second, {kNaN, 0, 0}, {}); });
}

TEST(Assertions, OfACallersMistakeReachTheHandler) {
#if defined(VP_ASSERTIONS) || !defined(NDEBUG)
  static int assertions = 0;
  const AssertHandler before =
      set_assert_handler([](const char*, const char*, int) { ++assertions; });
  World world;
  (void)world.pose(BodyId{3, 1});
  (void)world.velocity(BodyId{});
  (void)world.joint_position({}, 0, 0);
  set_assert_handler(before);
  EXPECT_EQ(assertions, 3);
#else
  World world;
  EXPECT_EQ(world.pose(BodyId{3, 1}), SE3{});  // asserts off: a harmless default
#endif
}

TEST(Step, StopsWhatLeavesTheRangeOfNumbers) {
  World world;
  const BodyId body = add_dynamic(world, {});
  must(world.set_velocity(body, {{}, {9.9e8, 0, 0}}));
  must(world.set_pose(body, SE3(Vec3{9.99e8, 0, 0})));
  bool told = false;
  for (int i = 0; i < 100; ++i) told |= must(world.step(0.1)).non_finite;
  EXPECT_TRUE(told);
  EXPECT_TRUE(is_finite(world.pose(body).position()));
}

std::vector<ContactEvent::Kind> kinds(const std::vector<ContactEvent>& events) {
  std::vector<ContactEvent::Kind> out;
  for (const ContactEvent& e : events) out.push_back(e.kind);
  return out;
}

TEST(Events, OfABounceAreBeginHitEnd) {
  World world;
  const Material bouncy{0.0, 0.5, 0.0};
  add_ground(world, bouncy);
  add_ball(world, {0, 0, kBallRadius + 0.05}, {0, 0, -2}, bouncy);
  std::vector<ContactEvent> events;
  for (int i = 0; i < 40; ++i) {
    must(world.step(0.001));
    for (const ContactEvent& e : world.contact_events()) {
      EXPECT_GE(e.time, 0.0);
      EXPECT_LE(e.time, 0.001);
      EXPECT_LT(e.a.index, e.b.index);
      events.push_back(e);
    }
  }
  using K = ContactEvent::Kind;
  ASSERT_EQ(kinds(events), (std::vector<K>{K::begin, K::hit, K::end}));
  const double mass = solid_inertia(Sphere{kBallRadius}, kBallDensity).mass();
  EXPECT_NEAR(events[1].approach_speed, std::sqrt(4 + 2 * 9.81 * 0.05), 0.01);
  EXPECT_NEAR(events[1].impulse, 1.5 * mass * events[1].approach_speed, 1e-6);
  EXPECT_NEAR(events[1].point.z, 0.0, 2e-4);
  EXPECT_NEAR(events[1].normal.z, 1.0, 1e-12);  // from the ground to the ball
}

TEST(Events, OfRestAreOneBegin) {
  World world;
  add_ground(world, {});
  add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.1})});
  int begins = 0, others = 0;
  for (int i = 0; i < 500; ++i) {
    must(world.step(0.001));
    for (const ContactEvent& e : world.contact_events()) {
      ++(e.kind == ContactEvent::Kind::begin ? begins : others);
    }
  }
  EXPECT_EQ(begins, 1);
  EXPECT_EQ(others, 0);
}

// A ball at 25 m/s is inside a plate of 1 mm for less than a step, and is still detected.
TEST(Sensor, SeesABallThatIsThroughWithinAStep) {
  World world({.gravity = {}});
  BodyDesc fixed;
  fixed.motion = Motion::fixed;
  const BodyId goal = must(world.create_body(fixed));
  ColliderDesc plate;
  plate.shape = Box{{0.0005, 0.2, 0.2}};
  plate.sensor = true;
  plate.user_data = 42;
  must(world.add_collider(goal, plate));
  const BodyId ball = add_ball(world, {-0.1005, 0, 0}, {45, 0, 0}, {});
  std::vector<ContactEvent> events;
  for (int i = 0; i < 10; ++i) {
    must(world.step(0.001));
    for (const ContactEvent& e : world.contact_events()) events.push_back(e);
  }
  using K = ContactEvent::Kind;
  ASSERT_EQ(kinds(events), (std::vector<K>{K::begin, K::end}));
  EXPECT_TRUE(events[0].sensor);
  EXPECT_EQ(events[0].user_data_a, 42u);
  EXPECT_EQ(events[0].impulse, 0.0);
  EXPECT_EQ(world.velocity(ball).v, (Vec3{45, 0, 0}));
}

// Balls so fast between walls so close that a pair separates and collides again within one step,
// with sensors side by side on their paths.
World rattle() {
  World world({.gravity = {}, .max_impacts_per_step = 64});
  const Material bouncy{0.0, 1.0, 0.0};
  const double gap = kBallRadius + 0.004;
  for (const double side : {-1.0, 1.0}) {
    add_fixed(world, Box{{0.05, 1, 1}}, bouncy, SE3(Vec3{side * (gap + 0.05), 0, 0}));
    add_fixed(world, Box{{1, 0.05, 1}}, bouncy, SE3(Vec3{0, side * 0.35, 0}));
    BodyDesc desc;
    desc.motion = Motion::fixed;
    ColliderDesc sensor;
    sensor.shape = Box{{0.2, 0.001, 1}};
    sensor.sensor = true;
    sensor.T_body_shape = SE3(Vec3{0, side * 0.004, 0});
    must(world.add_collider(must(world.create_body(desc)), sensor));
  }
  for (int i = 0; i < 4; ++i) {
    add_ball(world, {0, 0.12 * (i - 1.5), 0}, {18.0 + i, 6.0 - 5.0 * i, 0}, bouncy);
  }
  return world;
}

TEST(Events, BeginAndEndInTurnsEvenWhereAPairMeetsTwiceInAStep) {
  World world = rattle();
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> touching;
  int both_in_a_step = 0, solid_ends = 0, sensor_ends = 0;
  for (int step = 0; step < 2000; ++step) {
    must(world.step(0.001));
    std::set<std::pair<std::uint32_t, std::uint32_t>> ended;
    for (const ContactEvent& e : world.contact_events()) {
      const std::pair pair{e.a.index, e.b.index};
      bool& touches = touching[pair];
      if (e.kind == ContactEvent::Kind::begin) {
        EXPECT_FALSE(touches) << "a second begin, step " << step;
        touches = true;
        both_in_a_step += ended.count(pair) > 0;
      } else {
        EXPECT_TRUE(touches) << "a hit or end without a begin, step " << step;
        if (e.kind != ContactEvent::Kind::end) continue;
        touches = false;
        ended.insert(pair);
        ++(e.sensor ? sensor_ends : solid_ends);
      }
    }
  }
  EXPECT_GT(both_in_a_step, 100);
  EXPECT_GT(solid_ends, 1000);
  EXPECT_GT(sensor_ends, 10);
}

TEST(Events, AreInOrderOfTime) {
  World world = rattle();
  int later = 0;
  for (int step = 0; step < 2000; ++step) {
    must(world.step(0.001));
    double before = 0.0;
    for (const ContactEvent& e : world.contact_events()) {
      EXPECT_GE(e.time, before);
      EXPECT_LE(e.time, 0.001);
      later += e.time > before;
      before = e.time;
    }
  }
  EXPECT_GT(later, 1000);
}

TEST(Filter, LetsPassWhatIsNotInTheMask) {
  World world({.gravity = {}});
  BodyDesc fixed;
  fixed.motion = Motion::fixed;
  const BodyId wall = must(world.create_body(fixed));
  ColliderDesc box;
  box.shape = Box{{0.1, 1, 1}};
  box.filter = {2, 4};
  must(world.add_collider(wall, box));
  const BodyId ball = add_ball(world, {-0.5, 0, 0}, {10, 0, 0}, {});
  for (int i = 0; i < 100; ++i) must(world.step(0.001));
  EXPECT_NEAR(world.pose(ball).position().x, 0.5, 1e-9);
}

TEST(ImpactLimit, HoldsWhatWouldMeetAndSaysSo) {
  WorldDesc desc;
  desc.max_impacts_per_step = 0;
  World world(desc);
  add_ground(world, {0.0, 1.0, 0.0});
  const BodyId ball = add_ball(world, {0, 0, kBallRadius + 0.005}, {0, 0, -20}, {0.0, 1.0, 0.0});
  const StepStatus status = must(world.step(0.001));
  EXPECT_TRUE(status.impact_limit);
  EXPECT_NEAR(status.time_lost, 0.001, 1e-12);
  EXPECT_EQ(world.pose(ball).position().z, kBallRadius + 0.005);
}

}  // namespace
}  // namespace vp::test
