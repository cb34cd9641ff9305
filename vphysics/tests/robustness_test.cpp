// Worlds stay valid with any calls: each restores its own snapshots and continues with the same
// bits, bodies stopped at the impact limit gain no speed, and bodies under large forces do not pass
// through others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "joints_rig.h"
#include "random.h"
#include "samples.h"

namespace vp::test {
namespace {

std::vector<std::byte> snapshot_of(const World& world) {
  std::vector<std::byte> bytes;
  world.snapshot(bytes);
  return bytes;
}

// --- random worlds, with numbers up to the largest valid ones

class Wild {
 public:
  explicit Wild(std::uint64_t seed) : random_(seed) {
    WorldDesc desc;
    desc.sleep_after = chance(3) ? 0.5 : 0.0;
    if (chance(4)) desc.region_bodies = 1;
    if (chance(4)) desc.gravity = Vec3{0, 0, -magnitude(1.0, 1e8)};
    if (chance(4)) desc.max_impacts_per_step = 2;
    world = World(desc);
    add_ground(world, material());
    for (int i = 0; i < 8; ++i) add_something();
    for (int i = 0; i < 4; ++i) join_some();
    if (chance(2)) add_tree();
  }

  World world;

  // The same calls for the same seed. Many are rejected.
  void call() {
    const BodyId body = bodies_[random_.word() % bodies_.size()];
    const double large = magnitude(1.0, 1e12), other = magnitude(1.0, 1e9);
    const Vec3 v = random_.in_cube(1.0), w = random_.in_cube(1.0);
    const Vec3 point = world.pose(body).position() + 0.1 * w;
    const double mass = magnitude(1e-12, 1e8), radius = magnitude(1e-6, 1e3);
    const JointDrive drive{random_.uniform(-1, 1), random_.uniform(-10, 10), magnitude(1.0, 1e15),
                           magnitude(1e-3, 1e15), magnitude(1.0, 1e300)};
    switch (random_.word() % 12) {
      case 0:
        (void)world.apply_force(body, large * v, point);
        break;
      case 1:
        (void)world.apply_torque(body, large * v);
        break;
      case 2:
        (void)world.apply_impulse(body, large * v, point);
        break;
      case 3:
        (void)world.set_velocity(body, {other * v, other * w});
        break;
      case 4:
        (void)world.set_inertia(body, Inertia(mass, mass * radius * radius * Vec3{1, 1.2, 0.9}));
        break;
      case 5:
        (void)world.set_pose(body, SE3(random_.rotation(), other * v));
        break;
      case 6:
        (void)world.set_motion(body, static_cast<Motion>(random_.word() % 3));
        break;
      case 7:
        (void)world.set_gravity_scale(body, magnitude(1e-3, 1e6));
        break;
      case 8:
        (void)world.set_damping(body, magnitude(1e-3, 1e9), magnitude(1e-3, 1e9));
        break;
      case 9:
        if (!joints_.empty())
          (void)world.set_drive(joints_[random_.word() % joints_.size()], drive);
        break;
      case 10:
        (void)world.set_drive(tree_, 1, 0, drive);
        break;
      default:
        (void)world.apply_joint_force(tree_, 1, 0, v.x * other);
        break;
    }
  }
  double step_length() { return chance(2) ? 1.0 / 60.0 : magnitude(1e-6, 0.1); }

 private:
  bool chance(std::uint64_t one_in) { return random_.word() % one_in == 0; }
  double magnitude(double least, double most) {
    return std::exp(random_.uniform(std::log(least), std::log(most)));
  }
  Material material() {
    return {random_.uniform(0, 1), random_.uniform(0, 1), chance(2) ? 0.01 : 0.0, 0.0};
  }
  void add_something() {
    const double size = magnitude(1e-3, 1e1);
    const Shape shapes[] = {Sphere{size}, Box{size * Vec3{1.0, 0.5, 0.3}}, Capsule{size, size},
                            Cylinder{size, 0.5 * size}};
    Part part{.shape = shapes[random_.word() % 4], .material = material()};
    part.density = magnitude(1e-2, 1e5);
    part.pose = SE3(random_.rotation(), random_.in_cube(1.0) + Vec3{0, 0, 1});
    part.velocity = {random_.in_cube(3.0), random_.in_cube(chance(3) ? magnitude(1.0, 5e8) : 3.0)};
    part.continuous = chance(4) && std::holds_alternative<Sphere>(part.shape);
    bodies_.push_back(add_dynamic(world, part));
  }
  void join_some() {
    const JointKind kinds[] = {Hinge{},      Slider{},           Weld{},
                               BallSocket{}, Distance{0.1, 0.2}, Spring{0.1, 1e12, 1e9},
                               Gear{},       ConeTwist{}};
    JointDesc desc;
    desc.kind = kinds[random_.word() % std::size(kinds)];
    desc.T_a_joint = random_.pose(0.5);
    desc.T_b_joint = random_.pose(0.5);
    const std::size_t a = random_.word() % bodies_.size(), b = random_.word() % bodies_.size();
    const auto joint = world.create_joint(bodies_[a], bodies_[b], desc);
    if (joint) joints_.push_back(*joint);
  }
  void add_tree() {
    LinkSpec root, outer;
    root.joint = FreeJoint{};
    root.inertia = outer.inertia = Inertia(1.0, Vec3{1, 1, 1});
    root.T_parent_joint = SE3(Vec3{0, 0, 2});
    outer.parent = 0;
    outer.joint = RevoluteJoint{};
    outer.T_parent_joint = SE3(Vec3{0.5, 0, 0});
    tree_ = must(world.create_articulation({model_of({root, outer})}));
    ColliderDesc collider;
    collider.shape = Box{{0.3, 0.1, 0.1}};
    for (const int link : {0, 1}) {
      must(world.add_collider(world.link_body(tree_, link), collider));
      bodies_.push_back(world.link_body(tree_, link));
    }
  }

  Random random_;
  std::vector<BodyId> bodies_;
  std::vector<JointId> joints_;
  ArticulationId tree_;
};

// One world runs on. Its twin makes another step and is restored before each step. Any state that
// outlasts a step and is not in the snapshot makes the two differ. Before the fix, snapshots of 12
// of the 30 seeds were rejected, and 18 reported a position error one step late.
void go_on_after_restoring(std::uint64_t seed, int& out_of_range) {
  SCOPED_TRACE(seed);
  Wild straight(seed), rolled(seed);
  for (int step = 0; step < 30; ++step) {
    straight.call();
    rolled.call();
    const std::vector<std::byte> bytes = snapshot_of(straight.world);
    if (step % 2 == 0) must(rolled.world.step(0.003));
    const auto restored = rolled.world.restore(bytes);
    ASSERT_TRUE(restored.has_value()) << step << ": " << restored.error().message;
    const double dt = straight.step_length();
    ASSERT_EQ(dt, rolled.step_length());
    const StepStatus a = must(straight.world.step(dt)), b = must(rolled.world.step(dt));
    out_of_range += a.non_finite;
    ASSERT_EQ(straight.world.state_hash(), rolled.world.state_hash()) << step;
    for (const Limit limit : kLimits) ASSERT_EQ(reached(a, limit), reached(b, limit)) << step;
  }
}

TEST(Robustness, WildWorldsRestoreTheirSnapshotsAndGoOnToTheSameBits) {
  int out_of_range = 0;
  const int worlds = samples(30);
  for (int seed = 0; seed < worlds; ++seed)
    go_on_after_restoring(static_cast<std::uint64_t>(seed), out_of_range);
  EXPECT_GT(out_of_range, worlds);
}

TEST(Snapshot, CarriesThatTheLastStepHadAPositionError) {
  const auto overlap = [](World& world) {
    for (int i = 0; i < 3; ++i) add_dynamic(world, {.shape = Box{{0.5, 0.5, 0.5}}});
  };
  World straight(weightless()), restored(weightless());
  overlap(straight);
  overlap(restored);
  must(straight.step(0.001));
  must(restored.restore(snapshot_of(straight)));
  EXPECT_TRUE(must(straight.step(0.001)).position_error);
  EXPECT_TRUE(must(restored.step(0.001)).position_error);
}

// --- bodies stopped at the impact limit

// A ball, and a link above another ball, which the impact limit stops in every step once they would
// touch: at 1 m/s, by the 1 mm between them in a step of 1 ms. Before the fix, they had 9.8 m/s
// after a second.
TEST(ImpactLimit, CollectsNoSpeedFromGravity) {
  WorldDesc desc;
  desc.max_impacts_per_step = 0;
  World world(desc);
  add_ground(world, {});
  Part ball{.shape = Sphere{0.1}, .continuous = true};
  ball.pose = SE3(Vec3{0, 0, 0.101});
  const BodyId falls = add_dynamic(world, ball);
  ball.pose = SE3(Vec3{1, 0, 0.1});
  add_dynamic(world, ball);
  LinkSpec link;
  link.joint = PrismaticJoint{{0, 0, 1}};
  link.T_parent_joint = SE3(Vec3{1, 0, 0.251});
  link.inertia = solid_inertia(Box{{0.05, 0.05, 0.05}}, 1000.0);
  const ArticulationId slides = must(world.create_articulation({model_of({link})}));
  ColliderDesc collider;
  collider.shape = Box{{0.05, 0.05, 0.05}};
  must(world.add_collider(world.link_body(slides, 0), collider));
  int held = 0;
  for (int i = 0; i < 1000; ++i) held += must(world.step(0.001)).impact_limit;
  EXPECT_GT(held, 800);
  EXPECT_LT(norm(world.velocity(falls).v), 1.02);
  EXPECT_LT(std::fabs(world.joint_velocity(slides, 0, 0)), 1.02);
}

// --- large forces

// A force, or gravity, pulls the box towards a plate of 2 cm. Before the fix, at 60 Hz it passed
// the plate from 3e3 m/s^2 on. Now it penetrates by 8 cm at 3e4, since its contacts are soft.
TEST(Pulled, ABoxStaysOnItsSideOfAPlate) {
  for (const double rate : kRates) {
    for (const double pull : {1e2, 1e3, 3e3, 1e4, 3e4}) {
      for (const bool by_gravity : {false, true}) {
        SCOPED_TRACE(::testing::Message() << rate << " Hz, " << pull << " m/s^2");
        WorldDesc desc;
        desc.gravity = by_gravity ? Vec3{0, 0, -pull} : Vec3{};
        World world(desc);
        add_fixed(world, Box{{1, 1, 0.01}}, {});
        const BodyId box =
            add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.16})});
        const double weight = pull * world.inertia(box).mass();
        for (int i = 0; i < 10; ++i) {
          if (!by_gravity) must(world.apply_force(box, {0, 0, -weight}));
          must(world.step(1.0 / rate));
          ASSERT_GT(world.pose(box).position().z, 0.02) << i;
        }
      }
    }
  }
}

// A torque moves one of its ends by 0.8 m towards the plate in a step of 60 Hz.
TEST(Pulled, AStickStaysOnItsSideOfAPlate) {
  World world(weightless());
  add_fixed(world, Box{{2, 1, 0.01}}, {});
  const BodyId stick =
      add_dynamic(world, {.shape = Box{{1.0, 0.05, 0.05}}, .pose = SE3(Vec3{0, 0, 0.2})});
  const double moment = world.inertia(stick).central().yy;
  for (int i = 0; i < 3; ++i) {
    must(world.apply_torque(stick, {0, 6e3 * moment, 0}));
    must(world.step(1.0 / 60.0));
    const SE3 T = world.pose(stick);
    for (const double x : {-1.0, 1.0}) EXPECT_GT((T * Vec3{x, 0, 0}).z, -0.02) << i;
  }
}

// --- changes that would make loads invalid

struct Loaded {
  World world{weightless()};
  BodyId body;
};
Loaded loaded(const Vec3& force, const Vec3& torque) {
  Loaded l;
  BodyDesc desc;
  desc.inertia = Inertia(1e6, Vec3{1e6, 1e6, 1.0});
  l.body = must(l.world.create_body(desc));
  must(l.world.apply_force(l.body, force));
  must(l.world.apply_torque(l.body, torque));
  return l;
}

TEST(Loads, AreNotMadeMoreThanABodyBears) {
  Loaded l = loaded({1e15, 0, 0}, {1e15, 0, 0});
  const Inertia light(1.0, Vec3{1, 1, 1}), thin(1e6, Vec3{1e-3, 1e6, 1e6});
  const SE3 turned(Exp(Vec3{0, 0.5 * kPi, 0}), {});  // its thin z along the torque
  EXPECT_FALSE(l.world.set_inertia(l.body, light));
  EXPECT_FALSE(l.world.set_inertia(l.body, thin));
  EXPECT_FALSE(l.world.set_pose(l.body, turned));
  must(l.world.restore(snapshot_of(l.world)));
  EXPECT_FALSE(must(l.world.step(0.001)).non_finite);
  must(l.world.set_inertia(l.body, light));  // the step has cleared the load
  must(l.world.set_pose(l.body, turned));
}

TEST(Loads, AreNotMadeMoreThanABodyBearsByItsColliders) {
  World world(weightless());
  BodyDesc desc;
  const BodyId body = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = Sphere{10.0};
  collider.density = 1000.0;
  const ColliderId large = must(world.add_collider(body, collider));
  collider.shape = Sphere{0.1};
  must(world.add_collider(body, collider));
  must(world.apply_force(body, {1e15, 0, 0}));
  EXPECT_FALSE(world.remove_collider(large));
  EXPECT_FALSE(must(world.step(0.001)).non_finite);
  must(world.remove_collider(large));
}

// Impulses may give a body a velocity beyond the valid range, until the next step stops it.
TEST(Motion, WhatIsTooFastDoesNotBecomeKinematic) {
  World world(weightless());
  BodyDesc desc;
  desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
  const BodyId body = must(world.create_body(desc));
  for (int i = 0; i < 2; ++i) must(world.apply_impulse(body, {0.9e9, 0, 0}, {}));
  EXPECT_FALSE(world.set_motion(body, Motion::kinematic));
  must(world.restore(snapshot_of(world)));
}

}  // namespace
}  // namespace vp::test
