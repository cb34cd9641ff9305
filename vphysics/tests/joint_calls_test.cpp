// Joints as part of a world: ids, rejected arguments, collision filtering, snapshots.
#include <gtest/gtest.h>

#include "joints_rig.h"

namespace vp::test {
namespace {

const Inertia kSolid = solid_inertia(Box{{0.1, 0.1, 0.1}}, 1000.0);

struct Pair {
  World world;
  BodyId a = add_anchor(world), b = add_mass(world, kSolid, SE3(Vec3{0.3, 0, 0}));
};

bool refused(const Expected<JointId>& result, Errc code) {
  return !result && result.error().code == code && !result.error().message.empty();
}

TEST(CreateJoint, RefusesWhatIsNoJoint) {
  Pair p;
  const auto tries = [&](const JointKind& kind) {
    JointDesc desc;
    desc.kind = kind;
    return p.world.create_joint(p.a, p.b, desc);
  };
  const double inf = kNoLimit;
  SixDof driven, swung, odd;
  driven.axes[1] = {AxisMotion::locked, 0, 0, {0, 0, 1, 1, 1}};
  swung.axes[3] = {AxisMotion::limited, -4, 4, {}};
  odd.axes[0].motion = static_cast<AxisMotion>(9);
  const JointKind bad[] = {Hinge{1, -1, {}},
                           Hinge{kNaN, 1, {}},
                           Hinge{inf, inf, {}},
                           Hinge{-inf, -inf, {}},
                           Hinge{0, 1, {kNaN, 0, 0, 0, 0}},
                           Hinge{0, 1, {0, 0, -1, 0, 1}},
                           Hinge{0, 1, {0, 0, 0, 0, inf}},
                           Hinge{0, 1, {0, 0, 1e300, 0, 1}},
                           Slider{2, 1, {}},
                           Slider{-1e300, 1, {}},
                           Distance{-1, 1},
                           Distance{2, 1},
                           Distance{0, 0},
                           Distance{kNaN, 1},
                           Distance{0, kNaN},
                           Distance{inf, inf},
                           Spring{-1, 1, 1},
                           Spring{1, -1, 1},
                           Spring{1, 1, -1},
                           Spring{1, kNaN, 1},
                           Spring{1, inf, 1},
                           ConeTwist{0, 1, -1, 1, {}},
                           ConeTwist{1, -1, -1, 1, {}},
                           ConeTwist{1, 4, -1, 1, {}},
                           ConeTwist{kNaN, 1, -1, 1, {}},
                           ConeTwist{1, 1, 1, -1, {}},
                           driven,
                           swung,
                           odd,
                           Gear{0},
                           Gear{kNaN},
                           Gear{inf},
                           UserConstraint{}};
  for (const JointKind& kind : bad)
    EXPECT_TRUE(refused(tries(kind), Errc::invalid_argument)) << kind.index();
  JointDesc desc;
  for (const double x : {kNaN, -1.0, inf}) {
    desc = {};
    desc.frequency = x;
    EXPECT_TRUE(refused(p.world.create_joint(p.a, p.b, desc), Errc::invalid_argument));
    desc = {};
    desc.damping_ratio = x;
    EXPECT_TRUE(refused(p.world.create_joint(p.a, p.b, desc), Errc::invalid_argument));
  }
  desc = {};
  desc.T_a_joint = SE3(Vec3{kNaN, 0, 0});
  EXPECT_TRUE(refused(p.world.create_joint(p.a, p.b, desc), Errc::invalid_argument));
  desc = {};
  desc.T_b_joint = SE3(Mat3{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {});
  EXPECT_TRUE(refused(p.world.create_joint(p.a, p.b, desc), Errc::invalid_argument));
  EXPECT_TRUE(tries(BallSocket{}));
}

TEST(CreateJoint, RefusesBodiesThatCannotBeJoined) {
  Pair p;
  EXPECT_TRUE(refused(p.world.create_joint(p.b, p.b, {}), Errc::invalid_argument));
  EXPECT_TRUE(refused(p.world.create_joint(p.a, add_anchor(p.world), {}), Errc::invalid_argument));
  EXPECT_TRUE(refused(p.world.create_joint({}, p.b, {}), Errc::invalid_argument));
  const BodyId gone = add_mass(p.world, kSolid, SE3{});
  must(p.world.destroy_body(gone));
  EXPECT_TRUE(refused(p.world.create_joint(gone, p.b, {}), Errc::invalid_argument));
  // Continuous bodies are solved at impacts, others in sub-steps.
  const BodyId ball = add_ball(p.world, {1, 0, 0}, {}, {});
  EXPECT_TRUE(refused(p.world.create_joint(ball, p.b, {}), Errc::unsupported));
  EXPECT_TRUE(refused(p.world.create_joint(p.b, ball, {}), Errc::unsupported));
  const Rod rod = add_rod(p.world, 0, 1, 1, 0.1, {});
  EXPECT_TRUE(p.world.create_joint(p.b, rod.body, {}));
  EXPECT_TRUE(p.world.create_joint(ball, rod.body, {}));
  EXPECT_TRUE(p.world.create_joint(ball, p.a, {}));
}

TEST(Joint, IdsGoStaleAndNeverAlias) {
  Pair p;
  const JointId first = must(p.world.create_joint(p.a, p.b, {}));
  EXPECT_TRUE(p.world.contains(first));
  must(p.world.destroy_joint(first));
  EXPECT_FALSE(p.world.contains(first));
  EXPECT_FALSE(p.world.destroy_joint(first));
  EXPECT_FALSE(p.world.set_drive(first, {}));
  const JointId second = must(p.world.create_joint(p.a, p.b, {}));
  EXPECT_EQ(second.index, first.index);
  EXPECT_FALSE(p.world.contains(first));
  must(p.world.destroy_body(p.b));
  EXPECT_FALSE(p.world.contains(second));
  EXPECT_FALSE(p.world.contains(JointId{}));
  run(p.world, 0.01);
}

TEST(SetDrive, RefusesWhatTheJointHoldsOrDoesNotHave) {
  Pair p;
  const JointId ball = join(p.world, p.a, p.b, BallSocket{}, SE3{});
  EXPECT_FALSE(p.world.set_drive(ball, {}));
  EXPECT_FALSE(p.world.set_drive(ball, JointAxis::x, {}));
  EXPECT_TRUE(p.world.set_drive(ball, JointAxis::rotation_z, {0, 1, 0, 1, 1}));
  EXPECT_FALSE(p.world.set_drive(ball, JointAxis::rotation_z, {0, kNaN, 0, 1, 1}));
  EXPECT_FALSE(p.world.set_drive(ball, static_cast<JointAxis>(17), {}));
  JointDesc desc;
  desc.kind = Spring{1, 1, 1};
  EXPECT_FALSE(p.world.set_drive(must(p.world.create_joint(p.a, p.b, desc)), {}));
  desc.kind = ConeTwist{};
  const JointId cone = must(p.world.create_joint(p.a, p.b, desc));
  EXPECT_FALSE(p.world.set_drive(cone, JointAxis::rotation_x, {}));
  EXPECT_TRUE(p.world.set_drive(cone, {}));
}

// Two boxes that overlap, joined or not.
TEST(Joint, TheTwoMeetOnlyIfTheyAreAskedTo) {
  for (const bool collide : {false, true}) {
    World world(weightless());
    const Part box{.shape = Box{{0.1, 0.1, 0.1}}, .material = {}};
    const BodyId a = add_dynamic(world, box);
    Part other = box;
    other.pose = SE3(Vec3{0.15, 0, 0});
    const BodyId b = add_dynamic(world, other);
    SixDof free;
    JointDesc desc;
    desc.kind = free;
    desc.collide = collide;
    const JointId joint = must(world.create_joint(a, b, desc));
    run(world, 0.2);
    const double apart = norm(world.pose(b).position() - world.pose(a).position());
    if (collide) {
      EXPECT_GT(apart, 0.19);
      continue;
    }
    EXPECT_EQ(apart, 0.15);
    EXPECT_TRUE(world.contact_events().empty());
    must(world.destroy_joint(joint));
    run(world, 0.2);
    EXPECT_GT(norm(world.pose(b).position() - world.pose(a).position()), 0.19);
    must(world.set_pose(b, world.pose(a) * SE3(Vec3{0.15, 0, 0})));
    must(world.step(0.001));
    EXPECT_FALSE(world.contact_events().empty());
    must(world.create_joint(a, b, desc));  // the joint ends their contact
    must(world.step(0.001));
    ASSERT_EQ(world.contact_events().size(), 1u);
    EXPECT_EQ(world.contact_events()[0].kind, ContactEvent::Kind::end);
  }
}

// One joint of several kinds: a chain on a driven hinge, a gear, a spring, a cone, limits.
struct Machine {
  World world;
  JointId motor, cone;
};
Machine make_machine() {
  Machine m;
  World& world = m.world;
  add_ground(world, {});
  const BodyId anchor = add_anchor(world, SE3(Vec3{0, 0, 1.5}));
  const Part part{.shape = Box{{0.1, 0.05, 0.05}}, .material = {}};
  BodyId last = anchor;
  for (int i = 0; i < 4; ++i) {
    Part p = part;
    p.pose = SE3(Vec3{0.1 + 0.2 * i, 0, 1.5});
    const BodyId link = add_dynamic(world, p);
    const SE3 at(kAlongY, {0.2 * i, 0, 1.5});
    if (i == 0) m.motor = join(world, last, link, Hinge{-2, 2, {}}, at);
    if (i == 1) m.cone = join(world, last, link, ConeTwist{0.4, 0.6, -0.3, 0.3, {}}, at);
    if (i == 2) join(world, last, link, BallSocket{}, at);
    if (i == 3) join(world, last, link, Slider{-0.1, 0.2, {}}, at);
    last = link;
  }
  const BodyId wheel = add_mass(world, solid_inertia(Cylinder{0.2, 0.05}, 500), SE3(Vec3{0, 1, 1}));
  join(world, anchor, wheel, Hinge{-kNoLimit, kNoLimit, {0, 30, 0, 10, 5}}, SE3(Vec3{0, 1, 1}));
  const BodyId other = add_mass(world, solid_inertia(Cylinder{0.1, 0.05}, 500), SE3(Vec3{0, 2, 1}));
  join(world, anchor, other, Hinge{}, SE3(Vec3{0, 2, 1}));
  JointDesc desc;
  desc.kind = Gear{-2};
  must(world.create_joint(wheel, other, desc));
  desc.kind = Spring{0.5, 100, 1};
  must(world.create_joint(last, anchor, desc));
  return m;
}

TEST(Joint, SnapshotsRestoreToTheSameBits) {
  Machine m = make_machine(), other = make_machine();
  run(m.world, 0.7);
  must(m.world.set_drive(m.motor, {0.5, 0, 300, 10, 50}));
  run(m.world, 0.3);
  std::vector<std::byte> bytes;
  m.world.snapshot(bytes);
  must(other.world.restore(bytes));
  EXPECT_EQ(other.world.state_hash(), m.world.state_hash());
  EXPECT_EQ(other.world.joint_coordinate(m.motor), m.world.joint_coordinate(m.motor));
  for (int i = 0; i < 300; ++i) {
    must(m.world.step(0.001));
    must(other.world.step(0.001));
    ASSERT_EQ(other.world.state_hash(), m.world.state_hash()) << i;
  }
}

TEST(Joint, ASnapshotIsOfAWorldWithTheSameJoints) {
  const auto world_with = [](const JointKind& kind, bool destroyed) {
    Pair p;
    const JointId joint = join(p.world, p.a, p.b, kind, SE3{});
    if (destroyed) must(p.world.destroy_joint(joint));
    return std::move(p.world);
  };
  World hinge = world_with(Hinge{-1, 1, {}}, false);
  std::vector<std::byte> bytes;
  hinge.snapshot(bytes);
  EXPECT_TRUE(world_with(Hinge{-1, 1, {}}, false).restore(bytes));
  EXPECT_FALSE(world_with(Hinge{-1, 2, {}}, false).restore(bytes));
  EXPECT_FALSE(world_with(BallSocket{}, false).restore(bytes));
  EXPECT_FALSE(world_with(Hinge{-1, 1, {}}, true).restore(bytes));
}

}  // namespace
}  // namespace vp::test
