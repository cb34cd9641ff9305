// As in a game with rollback: every step is taken, rolled back and repeated.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "joints_rig.h"
#include "random.h"
#include "surfaces.h"
#include "tree_scenes.h"

namespace vp::test {
namespace {

constexpr double kTick = 0.001;

// VP_SYNC_STEPS=N sets the number of steps. Ten thousand take minutes under the sanitizers.
int sync_steps() {
  const char* wanted = std::getenv("VP_SYNC_STEPS");
  return wanted != nullptr ? std::atoi(wanted) : 600;
}

// Many features at once: a stack that falls asleep, boxes, joints with motors, rods, a walker, a
// continuous ball, a compound, a triangle mesh as ground, a sensor.
struct Everything {
  World world;
  std::vector<Rod> rods;
  std::vector<BodyId> loose;
  JointId hinge;
  BodyId ball;
};
// In regions of a few bodies.
WorldDesc drowsy() {
  WorldDesc desc;
  desc.sleep_after = 0.3;
  desc.region_bodies = 3;
  return desc;
}
Everything make_everything() {
  Everything e{World(drowsy()), {}, {}, {}, {}};
  World& world = e.world;
  const Material m{0.5, 0.3, 2e-4};
  add_ground(world, m);
  Random random(61);
  add_fixed(world, random_plane(random, 6, 2.0).made(), m, SE3(Vec3{3, 3, 0.2}));
  for (const double x : {-0.4, 0.4}) {
    add_fixed(world, Box{{0.02, 0.5, 0.2}}, m, SE3(Vec3{x, 0, 0.2}));
    add_fixed(world, Box{{0.5, 0.02, 0.2}}, m, SE3(Vec3{0, x, 0.2}));
  }
  for (const double x : {-0.15, 0.15}) e.rods.push_back(add_rod(world, x, 0.09, 3, 0.15, m));
  e.ball = add_ball(world, {0.02, 0.02, 0.03}, {8, 5, 0}, m);
  for (int i = 0; i < 4; ++i) {  // falls asleep
    add_dynamic(
        world,
        {.shape = Box{{0.1, 0.1, 0.1}}, .material = m, .pose = SE3(Vec3{-3, -3, 0.1 + 0.2 * i})});
  }
  const Shape shapes[] = {Box{{0.1, 0.08, 0.1}}, Capsule{0.08, 0.1}, Cylinder{0.1, 0.1},
                          Cone{0.1, 0.1}, Sphere{0.1}};
  for (int i = 0; i < 10; ++i) {
    e.loose.push_back(add_dynamic(
        world, {.shape = shapes[i % 5],
                .material = m,
                .pose = SE3(random.rotation(), Vec3{3.5 + 0.3 * (i % 3), 3.8, 0.6 + 0.3 * i})}));
  }
  const CompoundPart parts[] = {{Box{{0.15, 0.05, 0.05}}, {}},
                                {Box{{0.05, 0.15, 0.05}}, SE3(Vec3{0.1, 0.1, 0})}};
  Part angle{.shape = Compound::of(parts).value(), .material = m, .pose = SE3(Vec3{3.3, 3.3, 1})};
  e.loose.push_back(add_dynamic(world, angle));
  JointDesc joint;
  joint.T_a_joint = SE3(Vec3{0.15, 0, 0});
  joint.T_b_joint = SE3(Vec3{-0.15, 0, 0});
  joint.kind = Hinge{-1.0, 1.0, {0, 0, 1, 0.1, 0.5}};
  e.hinge = must(world.create_joint(e.loose[0], e.loose[1], joint));
  joint.kind = BallSocket{};
  must(world.create_joint(e.loose[2], e.loose[3], joint));
  (void)add_walker(world, {-3, 3, Walker::kHeight + 0.05}, m);
  BodyDesc watch;
  watch.motion = Motion::fixed;
  ColliderDesc sensor = collider_of(Box{{0.2, 0.2, 0.2}}, m);
  sensor.sensor = true;
  must(world.add_collider(must(world.create_body(watch)), sensor));
  return e;
}

void play(Everything& e, Random& random, int tick) {
  if (tick % 40 == 0) {
    for (const Rod& rod : e.rods) {
      must(
          e.world.set_drive(rod.articulation, 0, 0, {random.uniform(-0.1, 0.1), 0, 2e4, 300, 300}));
      must(e.world.set_drive(rod.articulation, 0, 1, {random.uniform(-2, 2), 0, 100, 0.8, 20}));
    }
    must(e.world.set_drive(e.hinge, {random.uniform(-1, 1), 0, 50, 5, 5}));
  }
  if (tick % 250 == 249) {  // an impulse that wakes it
    const auto k = static_cast<std::size_t>(random.word() % e.loose.size());
    const SE3 T = e.world.pose(e.loose[k]);
    must(e.world.apply_impulse(e.loose[k], random.in_cube(10.0), T.position()));
  }
  if (tick % 100 == 99) {
    must(e.world.set_pose(e.ball, SE3(Vec3{0.02, 0.02, 0.05})));
    must(e.world.set_velocity(e.ball, {{}, random.in_cube(10.0)}));
  }
  must(e.world.step(kTick));
}

// One world steps straight on. The other takes two steps, the second one a different step than the
// first world will take. It is then restored and repeats the first. The bits are always the same.
TEST(SyncTest, RollingBackEveryStepChangesNoBit) {
  Everything straight = make_everything(), rolled = make_everything();
  Random one(71), other(71);
  std::vector<std::byte> bytes;
  const int steps = sync_steps();
  int asleep = 0, impacts = 0, events = 0;
  std::uint32_t regions = 0;
  for (int tick = 0; tick < steps; ++tick) {
    bytes.clear();
    rolled.world.snapshot(bytes);
    const Random before = other;
    play(rolled, other, tick);
    must(rolled.world.step(0.004));
    must(rolled.world.restore(bytes));
    other = before;
    play(rolled, other, tick);
    play(straight, one, tick);
    ASSERT_EQ(straight.world.state_hash(), rolled.world.state_hash()) << tick;
    const StepCounters& counters = straight.world.counters();
    asleep += counters.awake < 16 ? 1 : 0;
    impacts += static_cast<int>(counters.impacts);
    events += static_cast<int>(counters.events);
    regions = std::max(regions, counters.regions);
  }
  EXPECT_GE(regions, 4u);
  std::printf("%d steps: %zu bytes a snapshot, some asleep in %d, %d impacts, %d events\n", steps,
              bytes.size(), asleep, impacts, events);
  EXPECT_GT(impacts, steps / 100);
  EXPECT_GT(asleep, steps / 4);
  EXPECT_GT(events, steps / 50);
}

}  // namespace
}  // namespace vp::test
