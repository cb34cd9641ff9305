// Bodies at rest fall asleep, cost nothing, and wake when needed.
#include <gtest/gtest.h>

#include "joints_rig.h"
#include "random.h"

namespace vp::test {
namespace {

WorldDesc sleepy() {
  WorldDesc desc;
  desc.sleep_after = 0.5;
  return desc;
}
constexpr double kHalf = 0.1;  // half edge of the boxes [m]

std::vector<BodyId> add_tower(World& world, int height, const Vec3& at = {}) {
  std::vector<BodyId> tower;
  for (int i = 0; i < height; ++i) {
    Part box{.shape = Box{{kHalf, kHalf, kHalf}}, .material = {}};
    box.pose = SE3(at + Vec3{0, 0, (2 * i + 1) * kHalf});
    tower.push_back(add_dynamic(world, box));
  }
  return tower;
}
bool all_asleep(const World& world, const std::vector<BodyId>& bodies) {
  return std::all_of(bodies.begin(), bodies.end(),
                     [&](BodyId body) { return world.is_asleep(body); });
}
bool none_asleep(const World& world, const std::vector<BodyId>& bodies) {
  return std::none_of(bodies.begin(), bodies.end(),
                      [&](BodyId body) { return world.is_asleep(body); });
}

// A sleeping tower on the ground.
struct Sleepers {
  World world{sleepy()};
  BodyId ground = add_ground(world, {});
  std::vector<BodyId> tower = add_tower(world, 5);

  Sleepers() {
    run(world, 1.0);
    EXPECT_TRUE(all_asleep(world, tower));
  }
};

TEST(Sleep, IsOffUnlessItIsAskedFor) {
  World world;
  add_ground(world, {});
  const auto tower = add_tower(world, 3);
  run(world, 2.0);
  EXPECT_TRUE(none_asleep(world, tower));
  EXPECT_EQ(world.counters().awake, 3u);
}

TEST(Sleep, ComesAfterTheTimeThatItIsAskedFor) {
  World world(sleepy());
  add_ground(world, {});
  const auto tower = add_tower(world, 3);
  run(world, 0.49);
  EXPECT_TRUE(none_asleep(world, tower));
  run(world, 0.2);
  EXPECT_TRUE(all_asleep(world, tower));
}

// Bodies that come to rest first wait for the last one, and no longer.
TEST(Sleep, ComesToAllWhenTheLastHasRested) {
  for (const double height : {0.0, 0.02, 0.1, 0.3, 1.0}) {
    World world(sleepy());
    add_ground(world, {});
    const auto boxes = add_tower(world, 2);
    must(world.set_pose(boxes[1], SE3(Vec3{0, 0, 3 * kHalf + height})));
    const double reach = std::sqrt(3.0) * kHalf;
    double last_fast = 0.0, slept = -1.0;
    for (int i = 1; i <= 5000 && slept < 0.0; ++i) {
      must(world.step(0.001));
      for (const BodyId box : boxes) {
        const se3 V = world.velocity(box);
        if (norm(V.v) + reach * norm(V.w) >= sleepy().sleep_speed) last_fast = 0.001 * i;
      }
      if (all_asleep(world, boxes)) slept = 0.001 * i;
    }
    // Measured: 0.500 s.
    EXPECT_NEAR(slept - last_fast, sleepy().sleep_after, 0.003) << "from " << height;
    must(world.wake(boxes[0]));
    EXPECT_TRUE(none_asleep(world, boxes));
    run(world, 0.51);
    EXPECT_TRUE(all_asleep(world, boxes)) << "again, from " << height;
  }
}

// Many bodies come to rest at different times, among them balls that spin on a point, which
// spinning friction stops.
class SleepIn : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Heaps, SleepIn, testing::Range<std::uint64_t>(71, 75));
TEST_P(SleepIn, AWholePitComesToAll) {
  World world(sleepy());
  add_ground(world, {});
  for (const double at : {-1.0, 1.0}) {
    add_fixed(world, Box{{0.1, 1.2, 2}}, {}, SE3(Vec3{at, 0, 2}));
    add_fixed(world, Box{{1.2, 0.1, 2}}, {}, SE3(Vec3{0, at, 2}));
  }
  const Shape kinds[] = {Box{{0.12, 0.1, 0.08}}, Sphere{0.1}, Capsule{0.06, 0.1},
                         Cylinder{0.09, 0.1}, Box{{0.1, 0.1, 0.1}}};
  Random random(GetParam());
  std::vector<BodyId> bodies;
  for (int i = 0; i < 200; ++i) {
    Part part{.shape = kinds[i % 5],
              .material = {.friction = 0.5, .rolling_friction = 0.01, .spinning_friction = 0.005}};
    const double level = 0.3 + 0.3 * (i / 25), x = 0.3 * (i % 5) - 0.6, y = 0.3 * (i / 5 % 5) - 0.6;
    part.pose = SE3(random.rotation(), Vec3{x, y, level});
    bodies.push_back(add_dynamic(world, part));
  }
  double slept = -1.0;
  for (int i = 1; i <= 2500 && slept < 0.0; ++i) {
    must(world.step(0.004));
    if (all_asleep(world, bodies)) slept = 0.004 * i;
  }
  EXPECT_GT(slept, 1.0);
  must(world.wake(bodies[0]));
  must(world.step(0.004));
  EXPECT_GT(world.counters().awake, 10u);  // with the heap around it
}

TEST(Sleep, MovesNothingAndLooksAtNothing) {
  Sleepers s;
  std::vector<SE3> poses;
  for (const BodyId body : s.tower) poses.push_back(s.world.pose(body));
  for (int i = 0; i < 100; ++i) {
    must(s.world.step(0.001));
    ASSERT_EQ(s.world.counters().awake, 0u);
    ASSERT_EQ(s.world.counters().contacts, 0u);
    ASSERT_EQ(s.world.counters().narrow_phase_pairs, 0u);
    ASSERT_TRUE(s.world.contact_events().empty());
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(s.world.pose(s.tower[i]), poses[i]);
    EXPECT_EQ(s.world.velocity(s.tower[i]), se3{});
  }
}

TEST(Sleep, GoesOnWhereItStopped) {
  Sleepers s;
  const SE3 top = s.world.pose(s.tower.back());
  must(s.world.wake(s.tower.front()));
  EXPECT_TRUE(none_asleep(s.world, s.tower));
  double fastest = 0.0;
  for (int i = 0; i < 100; ++i) {
    must(s.world.step(0.001));
    fastest = std::max(fastest, norm(s.world.velocity(s.tower.back()).v));
    ASSERT_TRUE(s.world.contact_events().empty());  // they were in contact all the time
  }
  // Warm starting keeps it almost still: 0.02 mm/s. Without, it would sink.
  EXPECT_LT(fastest, 1e-4);
  EXPECT_LT(norm(s.world.pose(s.tower.back()).position() - top.position()), 1e-6);
}

TEST(Sleep, EndsForAllThatHangTogetherAndForNoOther) {
  World world(sleepy());
  add_ground(world, {});
  const auto near = add_tower(world, 4), far = add_tower(world, 4, {5, 0, 0});
  run(world, 1.0);
  ASSERT_TRUE(all_asleep(world, near) && all_asleep(world, far));
  Part ball{.shape = Sphere{0.05}, .material = {}};
  ball.pose = SE3(Vec3{-0.5, 0, 0.3});
  ball.velocity = {{}, {4, 0, 0}};
  add_dynamic(world, ball);
  int steps = 0;
  while (all_asleep(world, near) && ++steps < 1000) must(world.step(0.001));
  // A distance of 0.35 m at 4 m/s.
  EXPECT_NEAR(steps, 88, 4);
  EXPECT_TRUE(none_asleep(world, near));
  EXPECT_TRUE(all_asleep(world, far));
  run(world, 0.1);
  EXPECT_GT(world.pose(near[1]).position().x, 1e-3);  // the ball has moved it
}

TEST(Sleep, EndsByTheCallsThatChangeABody) {
  const auto wakes = [](const char* what, const auto& call) {
    Sleepers s;
    call(s);
    EXPECT_TRUE(none_asleep(s.world, s.tower)) << what;
    run(s.world, 0.05);
  };
  wakes("set_pose", [](Sleepers& s) { must(s.world.set_pose(s.tower[4], SE3(Vec3{0, 0, 2}))); });
  wakes("set_velocity", [](Sleepers& s) {
    must(s.world.set_velocity(s.tower[0], {{}, {0.1, 0, 0}}));
  });
  wakes("apply_impulse", [](Sleepers& s) {
    must(s.world.apply_impulse(s.tower[2], {1, 0, 0}, {0, 0, 0.5}));
  });
  wakes("add_collider", [](Sleepers& s) {
    ColliderDesc more;
    more.shape = Sphere{0.15};
    must(s.world.add_collider(s.tower[2], more));
  });
  wakes("set_pose of what carries them", [](Sleepers& s) {
    must(s.world.set_pose(s.ground, SE3(Vec3{0, 0, -0.5})));
  });
  wakes("create_joint", [](Sleepers& s) {
    join(s.world, s.ground, s.tower[1], BallSocket{}, SE3(Vec3{0, 0, 0.3}));
  });
}

TEST(Sleep, EndsWhenWhatCarriesThemIsDestroyed) {
  Sleepers s;
  must(s.world.destroy_body(s.tower[0]));
  s.tower.erase(s.tower.begin());
  EXPECT_TRUE(none_asleep(s.world, s.tower));
  const double z = s.world.pose(s.tower[0]).position().z;
  run(s.world, 0.1);
  EXPECT_NEAR(z - s.world.pose(s.tower[0]).position().z, 0.5 * 9.81 * 0.01, 2e-3);
}

TEST(Sleep, WaitsForWhatIsMovedUnderIt) {
  World world(sleepy());
  BodyDesc floor;
  floor.motion = Motion::kinematic;
  const BodyId belt = must(world.create_body(floor));
  ColliderDesc slab;
  slab.shape = Box{{50, 1, 0.1}};
  slab.T_body_shape = SE3(Vec3{0, 0, -0.1});
  must(world.add_collider(belt, slab));
  const auto tower = add_tower(world, 2);
  must(world.set_velocity(belt, {{}, {0.001, 0, 0}}));
  run(world, 2.0);
  EXPECT_TRUE(none_asleep(world, tower));
  must(world.set_velocity(belt, {}));
  run(world, 1.0);
  EXPECT_TRUE(all_asleep(world, tower));
  must(world.set_velocity(belt, {{}, {0.2, 0, 0}}));
  EXPECT_TRUE(none_asleep(world, tower));
  const double x = world.pose(tower[0]).position().x;
  run(world, 1.0);
  EXPECT_NEAR(world.pose(tower[0]).position().x - x, 0.2, 0.01);
}

TEST(Sleep, IsForWhatJointsHoldToo) {
  World world(sleepy());
  const BodyId anchor = add_anchor(world);
  const Inertia bar = solid_inertia(Box{{0.05, 0.05, 0.2}}, 1000);
  const BodyId a = add_mass(world, bar, SE3(Vec3{0, 0, -0.2}));
  const BodyId b = add_mass(world, bar, SE3(Vec3{0, 0, -0.6}));
  join(world, anchor, a, BallSocket{}, SE3{});
  Hinge hinge;
  hinge.drive = {.position = 0.0, .stiffness = 100, .damping = 10, .max_force = 50};
  const JointId motor = join(world, a, b, hinge, SE3(kAlongY, {0, 0, -0.4}));
  run(world, 1.0);
  ASSERT_TRUE(all_asleep(world, {a, b}));
  const JointForce carried = world.joint_force(motor);
  EXPECT_NEAR(carried.force.z, 9.81 * bar.mass(), 0.01 * 9.81 * bar.mass());
  run(world, 0.1);
  EXPECT_EQ(world.joint_force(motor).force, carried.force);
  hinge.drive.position = 0.5;
  must(world.set_drive(motor, hinge.drive));
  EXPECT_TRUE(none_asleep(world, {a, b}));
  run(world, 0.3);
  EXPECT_GT(std::fabs(world.joint_coordinate(motor)), 0.1);
}

TEST(Sleep, EndsBeforeASweptBallArrives) {
  Sleepers s;
  Part ball{.shape = Sphere{0.05}, .material = {}};
  ball.pose = SE3(Vec3{-2, 0, 0.3});
  ball.velocity = {{}, {25, 0, 0}};
  ball.continuous = true;
  add_dynamic(s.world, ball);
  run(s.world, 0.2);
  EXPECT_TRUE(none_asleep(s.world, s.tower));
  EXPECT_GT(s.world.pose(s.tower[1]).position().x, 0.01);
}

TEST(Sleep, LeavesSensorsAsTheyAre) {
  World world(sleepy());
  add_ground(world, {});
  const auto tower = add_tower(world, 1);
  BodyDesc zone;
  zone.motion = Motion::fixed;
  const BodyId where = must(world.create_body(zone));
  ColliderDesc gate;
  gate.shape = Sphere{0.3};
  gate.sensor = true;
  must(world.add_collider(where, gate));
  run(world, 1.0);
  ASSERT_TRUE(all_asleep(world, tower));
  must(world.step(0.001));
  EXPECT_TRUE(world.contact_events().empty());
  must(world.set_pose(tower[0], SE3(Vec3{3, 0, kHalf})));
  must(world.step(0.001));
  const auto events = world.contact_events();
  EXPECT_TRUE(std::any_of(events.begin(), events.end(), [](const ContactEvent& e) {
    return e.kind == ContactEvent::Kind::end && e.sensor;
  }));
}

// A snapshot restored while bodies sleep gives the same bits.
TEST(Sleep, IsPartOfTheState) {
  const auto make = [] {
    World world(sleepy());
    add_ground(world, {});
    add_tower(world, 4);
    add_tower(world, 3, {3, 0, 0});
    Part ball{.shape = Sphere{0.1}, .material = {}};
    ball.pose = SE3(Vec3{0.02, 0.01, 8});
    add_dynamic(world, ball);
    return world;
  };
  World a = make(), b = make();
  run(a, 1.1);  // the ball is about to hit sleeping bodies
  EXPECT_EQ(a.counters().awake, 1u);
  std::vector<std::byte> bytes;
  a.snapshot(bytes);
  must(b.restore(bytes));
  EXPECT_EQ(b.state_hash(), a.state_hash());
  std::uint32_t most = 0;
  for (int i = 0; i < 3000; ++i) {
    must(a.step(0.001));
    must(b.step(0.001));
    ASSERT_EQ(a.state_hash(), b.state_hash()) << "step " << i;
    most = std::max(most, a.counters().awake);
  }
  EXPECT_EQ(most, 5u);     // with the tower that the ball hits
  must(b.restore(bytes));  // bodies that have woken sleep again
  run(b, 0.5);
  World c = make();
  run(c, 1.6);
  EXPECT_EQ(b.state_hash(), c.state_hash());
}

// Objects that are created or moved beside sleeping bodies have the same effects whether any other
// body is awake or not.
struct News {
  std::vector<ContactEvent> events;
  std::vector<SE3> poses;
  std::uint32_t narrow_phase_pairs = 0;  // in the last step
};
template <class F>
News after_change(bool with_ball, const F& change, double time = 0.1) {
  World world(sleepy());
  add_ground(world, {});
  const BodyId shelf = add_fixed(world, Box{{0.2, 0.2, 0.05}}, {}, SE3(Vec3{0, 9, 5}));
  const auto boxes = add_tower(world, 2);
  run(world, 1.0);
  const SE3 far(Vec3{30, 0, 100});
  if (with_ball) {
    add_dynamic(world, {.shape = Sphere{0.1}, .pose = far});
  } else {
    add_fixed(world, Sphere{0.1}, {}, far);  // for the same ids
  }
  must(world.step(0.001));
  EXPECT_EQ(world.counters().awake, with_ball ? 1u : 0u);
  change(world, shelf);
  News news;
  for (double t = 0.0; t < time; t += 0.001) {
    must(world.step(0.001));
    const auto events = world.contact_events();
    news.events.insert(news.events.end(), events.begin(), events.end());
  }
  for (const BodyId box : boxes) news.poses.push_back(world.pose(box));
  news.narrow_phase_pairs = world.counters().narrow_phase_pairs;
  return news;
}
template <class F>
News same_with_and_without_others(const F& change) {
  const News alone = after_change(false, change), beside = after_change(true, change);
  EXPECT_EQ(alone.poses, beside.poses);
  EXPECT_EQ(alone.narrow_phase_pairs, beside.narrow_phase_pairs);
  EXPECT_EQ(alone.events.size(), beside.events.size());
  for (std::size_t i = 0; i < std::min(alone.events.size(), beside.events.size()); ++i) {
    EXPECT_EQ(alone.events[i].kind, beside.events[i].kind);
    EXPECT_EQ(alone.events[i].a, beside.events[i].a);
    EXPECT_EQ(alone.events[i].b, beside.events[i].b);
  }
  return alone;
}
// The centre of the upper box, which extends by 0.1 m to each side.
constexpr Vec3 kUpper{0, 0, 3 * kHalf};

TEST(Sleep, EndsByWhatIsMadeInItsPlace) {
  const News box = same_with_and_without_others([](World& world, BodyId) {
    add_fixed(world, Box{{0.1, 0.1, 0.02}}, {}, SE3(kUpper + Vec3{0.19, 0, 0}));
  });
  ASSERT_FALSE(box.events.empty());
  EXPECT_EQ(box.events[0].kind, ContactEvent::Kind::begin);
  EXPECT_LT(box.poses[1].position().x, -0.005);
  const News more = same_with_and_without_others([](World& world, BodyId shelf) {
    ColliderDesc board;
    board.shape = Box{{0.1, 0.1, 0.02}};
    board.T_body_shape = SE3(kUpper + Vec3{0.19, 0, 0} - Vec3{0, 9, 5});
    must(world.add_collider(shelf, board));
  });
  EXPECT_LT(more.poses[1].position().x, -0.005);
}

TEST(Sleep, EndsByWhatIsPutInItsPlace) {
  const News news = same_with_and_without_others([](World& world, BodyId shelf) {
    must(world.set_pose(shelf, SE3(kUpper + Vec3{0.29, 0, 0})));
  });
  ASSERT_FALSE(news.events.empty());
  EXPECT_LT(news.poses[1].position().x, -0.005);
}

TEST(Sleep, DoesNotMindWhatIsMadeBesideIt) {
  const News news = same_with_and_without_others([](World& world, BodyId) {
    add_fixed(world, Box{{0.1, 0.1, 0.02}}, {}, SE3(kUpper + Vec3{0.202, 0, 0}));
  });
  EXPECT_TRUE(news.events.empty());
  EXPECT_EQ(news.narrow_phase_pairs, 0u);
}

TEST(Sleep, IsSeenBySensorsMadeOrPutThere) {
  const auto add_gate = [](World& world, const Vec3& at) {
    BodyDesc zone;
    zone.motion = Motion::fixed;
    zone.T_world_body = SE3(at);
    const BodyId body = must(world.create_body(zone));
    ColliderDesc gate;
    gate.shape = Sphere{0.12};
    gate.sensor = true;
    must(world.add_collider(body, gate));
    return body;
  };
  const auto made = [&](World& world, BodyId) { add_gate(world, kUpper + Vec3{0.2, 0, 0}); };
  const auto put = [&](World& world, BodyId) {
    const BodyId gate = add_gate(world, {0, 50, 0});
    must(world.step(0.001));
    must(world.set_pose(gate, SE3(kUpper + Vec3{0.2, 0, 0})));
  };
  for (const News& news : {same_with_and_without_others(made), same_with_and_without_others(put)}) {
    ASSERT_EQ(news.events.size(), 1u);
    EXPECT_EQ(news.events[0].kind, ContactEvent::Kind::begin);
    EXPECT_TRUE(news.events[0].sensor);
    EXPECT_EQ(news.narrow_phase_pairs, 0u);  // not again in each step
  }
}

// A link neither sleeps nor moves in sub-steps.
TEST(Sleep, EndsBeforeALinkArrives) {
  const News news = same_with_and_without_others([](World& world, BodyId) {
    LinkSpec slider;
    slider.joint = PrismaticJoint{.axis = {1, 0, 0}};
    slider.T_parent_joint = SE3(kUpper + Vec3{0.25, 0, 0});
    slider.inertia = solid_inertia(Box{{0.1, 0.05, 0.05}}, 1000);
    const ArticulationId pusher = must(world.create_articulation({model_of({slider})}));
    ColliderDesc head;
    head.shape = Box{{0.1, 0.05, 0.05}};
    must(world.add_collider(world.link_body(pusher, 0), head));
    must(world.set_joint_state(pusher, 0, 0, 0.0, -3.0));
  });
  EXPECT_FALSE(news.events.empty());
  EXPECT_LT(news.poses[1].position().x, -0.02);
}

// Also when a sensor was created after all bodies fell asleep.
TEST(Sleep, IsTheSameAfterARestore) {
  const auto make = [] {
    World world(sleepy());
    add_ground(world, {});
    add_tower(world, 2);
    run(world, 1.0);
    BodyDesc zone;
    zone.motion = Motion::fixed;
    ColliderDesc gate;
    gate.shape = Sphere{0.15};
    gate.sensor = true;
    must(world.add_collider(must(world.create_body(zone)), gate));
    return world;
  };
  World a = make(), b = make();
  std::size_t events = 0;
  for (int i = 0; i < 5; ++i) {
    std::vector<std::byte> bytes;
    a.snapshot(bytes);
    must(b.restore(bytes));
    for (int k = 0; k < 3; ++k) {
      must(a.step(0.001));
      must(b.step(0.001));
      events += a.contact_events().size();
      ASSERT_EQ(a.contact_events().size(), b.contact_events().size());
      ASSERT_EQ(a.state_hash(), b.state_hash());
      ASSERT_EQ(a.counters().awake, 0u);
    }
  }
  EXPECT_EQ(events, 1u);
}

TEST(Sleep, RefusesBodiesThatAreGone) {
  Sleepers s;
  const BodyId gone = s.tower[4];
  must(s.world.destroy_body(gone));
  const auto woken = s.world.wake(gone);
  ASSERT_FALSE(woken.has_value());
  EXPECT_EQ(woken.error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace vp::test
