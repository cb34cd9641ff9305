// Rods: joints in reduced coordinates, their motors and stops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rig.h"

namespace vp::test {
namespace {

struct OneJoint {
  World world;
  ArticulationId id;
  BodyId body;
};
OneJoint make_joint(const LinkSpec& link, const Vec3& gravity = {}) {
  OneJoint joint{World({.gravity = gravity}), {}, {}};
  joint.id = must(joint.world.create_articulation({model_of({link})}));
  joint.body = joint.world.link_body(joint.id, 0);
  return joint;
}
LinkSpec link_of(const Joint& joint) {
  LinkSpec link;
  link.joint = joint;
  link.inertia = Inertia(2.0, Vec3{0.1, 0.1, 0.02});
  return link;
}

TEST(Drive, ReachesItsTargetAndStays) {
  OneJoint j = make_joint(rod_link(0, 0));
  must(j.world.set_drive(j.id, 0, 0, {0.05, 0.0, 3e4, 500.0, 400.0}));
  must(j.world.set_drive(j.id, 0, 1, {1.2, 0.0, 60.0, 0.6, 20.0}));
  for (int i = 0; i < 1000; ++i) must(j.world.step(kDt));
  EXPECT_NEAR(j.world.joint_position(j.id, 0, 0), 0.05, 1e-6);
  EXPECT_NEAR(j.world.joint_position(j.id, 0, 1), 1.2, 1e-6);
  EXPECT_NEAR(j.world.joint_velocity(j.id, 0, 0), 0.0, 1e-5);
}

TEST(Drive, OfAllJointsAtOnceIsThatOfEach) {
  OneJoint one = make_joint(rod_link(0, 0)), all = make_joint(rod_link(0, 0));
  const JointDrive drives[] = {{0.05, 0.0, 3e4, 500.0, 400.0}, {1.2, 0.0, 60.0, 0.6, 20.0}};
  for (int i = 0; i < 2; ++i) must(one.world.set_drive(one.id, 0, i, drives[i]));
  must(all.world.set_drives(all.id, drives));
  for (OneJoint* j : {&one, &all}) {
    for (int i = 0; i < 100; ++i) must(j->world.step(kDt));
  }
  EXPECT_EQ(one.world.state_hash(), all.world.state_hash());
}

// With any gains, no step changes the momentum by more than max_force * dt.
TEST(Drive, NeverExceedsItsForce) {
  for (const double stiffness : {1e2, 1e6, 1e12}) {
    OneJoint j = make_joint(link_of(PrismaticJoint{}));
    const double most = 3.0;
    double before = 0.0;
    for (int i = 0; i < 500; ++i) {
      must(j.world.set_drive(j.id, 0, 0, {i / 100 % 2 ? 1.0 : -1.0, 0.0, stiffness, 10.0, most}));
      must(j.world.step(kDt));
      const double now = j.world.joint_velocity(j.id, 0, 0);
      ASSERT_LE(std::fabs(now - before) * 2.0, most * kDt * (1 + 1e-9));
      before = now;
    }
  }
}

TEST(Drive, AnyStiffnessIsStable) {
  for (const double stiffness : {1.0, 1e4, 1e8, 1e15}) {
    OneJoint j = make_joint(link_of(RevoluteJoint{}));
    must(j.world.set_drive(j.id, 0, 0, {0.5, 0.0, stiffness, 0.0, 1e12}));
    double farthest = 0.0;
    for (int i = 0; i < 2000; ++i) {
      must(j.world.step(kDt));
      farthest = std::max(farthest, std::fabs(j.world.joint_position(j.id, 0, 0)));
    }
    EXPECT_LT(farthest, 1.01) << stiffness;
  }
}

// A motor presses a box against a wall with exactly k (target - q). The contact's impulse shows the
// force.
TEST(Drive, PressesWithItsSpringForce) {
  OneJoint j = make_joint(link_of(PrismaticJoint{}));
  ColliderDesc box;
  box.shape = Box{{0.1, 0.1, 0.1}};
  must(j.world.add_collider(j.body, box));
  const BodyId load = add_dynamic(
      j.world, {.shape = Box{{0.1, 0.1, 0.1}}, .density = 100.0, .pose = SE3(Vec3{0, 0, 0.2})});
  const SE3 behind(Vec3{0, 0, 0.4});
  const BodyId wall = add_fixed(j.world, Box{{1, 1, 0.1}}, {}, behind);
  const double k = 1e4, target = 0.01;
  must(j.world.set_drive(j.id, 0, 0, {target, 0.0, k, 300.0, 1e3}));
  for (int i = 0; i < 2000; ++i) must(j.world.step(kDt));
  const double q = j.world.joint_position(j.id, 0, 0);
  EXPECT_LT(std::fabs(q), 4e-4);
  EXPECT_NEAR(j.world.pose(load).position().z, 0.2, 4e-4);
  EXPECT_NEAR(j.world.joint_velocity(j.id, 0, 0), 0.0, 1e-4);
  // A new wall replaces the old one. The begin event of its first contact reports the impulse.
  must(j.world.destroy_body(wall));
  add_fixed(j.world, Box{{1, 1, 0.1}}, {}, behind);
  must(j.world.step(kDt));
  const auto events = j.world.contact_events();
  const auto begin = std::find_if(events.begin(), events.end(), [](const ContactEvent& e) {
    return e.kind == ContactEvent::Kind::begin;
  });
  ASSERT_NE(begin, events.end());
  EXPECT_NEAR(begin->impulse / kDt, k * (target - q), 0.01 * k * target);
}

TEST(Limit, HoldsAgainstAMotor) {
  for (const double target : {-1.0, 1.0}) {
    LinkSpec link = link_of(CylindricalJoint{});
    link.forces = {stops(-0.1, 0.2), stops(-0.3, 0.5)};
    OneJoint j = make_joint(link);
    must(j.world.set_drive(j.id, 0, 0, {target, 0.0, 1e5, 10.0, 1e4}));
    must(j.world.set_drive(j.id, 0, 1, {target, 0.0, 1e4, 1.0, 1e3}));
    for (int i = 0; i < 1000; ++i) {
      must(j.world.step(kDt));
      const double slide = j.world.joint_position(j.id, 0, 0);
      const double angle = j.world.joint_position(j.id, 0, 1);
      ASSERT_GE(slide, -0.1 - 1e-9);
      ASSERT_LE(slide, 0.2 + 1e-9);
      ASSERT_GE(angle, -0.3 - 1e-9);
      ASSERT_LE(angle, 0.5 + 1e-9);
    }
    EXPECT_NEAR(j.world.joint_position(j.id, 0, 0), target < 0 ? -0.1 : 0.2, 1e-6);
    EXPECT_NEAR(j.world.joint_position(j.id, 0, 1), target < 0 ? -0.3 : 0.5, 1e-6);
  }
}

TEST(Limit, AJointBeginsAtTheStopNextToZero) {
  LinkSpec link = link_of(PrismaticJoint{});
  link.forces = {stops(0.3, 0.5)};
  OneJoint j = make_joint(link);
  EXPECT_EQ(j.world.joint_position(j.id, 0, 0), 0.3);
  must(j.world.step(kDt));
  EXPECT_EQ(j.world.joint_position(j.id, 0, 0), 0.3);
}

// A mass of 2 kg with weight 2 g presses on a soft limit of 500 N/m: it rests g m / k beyond the
// limit.
TEST(Limit, ASoftOneGivesWay) {
  LinkSpec link = link_of(PrismaticJoint{});
  link.forces = {stops(-0.1, 1.0)};
  link.forces[0].limit_stiffness = 500.0;
  link.forces[0].limit_damping = 40.0;
  OneJoint j = make_joint(link, {0, 0, -9.81});
  for (int i = 0; i < 3000; ++i) must(j.world.step(kDt));
  EXPECT_NEAR(j.world.joint_position(j.id, 0, 0), -0.1 - 2.0 * 9.81 / 500.0, 1e-6);
}

TEST(Spring, SwingsWithItsPeriodAndIsStableAtAnyStiffness) {
  LinkSpec link = link_of(PrismaticJoint{});
  link.forces = {JointForces{}};
  link.forces[0].stiffness = 200.0;
  link.forces[0].rest = 0.5;
  OneJoint j = make_joint(link);
  const double period = 2 * kPi * std::sqrt(2.0 / 200.0);
  double highest = 0.0, at = 0.0;
  for (int i = 1; i <= 700; ++i) {  // past the first turning point, at 2 rest
    must(j.world.step(kDt));
    const double q = j.world.joint_position(j.id, 0, 0);
    if (q > highest) highest = q, at = i * kDt;
  }
  EXPECT_NEAR(at, period / 2, 0.01 * period);
  EXPECT_NEAR(highest, 1.0, 0.03);  // implicit integration loses a little energy
  link.forces[0].stiffness = 1e15;
  OneJoint stiff = make_joint(link, {0, 0, -9.81});
  for (int i = 0; i < 100; ++i) must(stiff.world.step(kDt));
  EXPECT_NEAR(stiff.world.joint_position(stiff.id, 0, 0), 0.5, 1e-9);
}

// Sliding at 1 m/s against a friction of 3 N, a mass of 2 kg stops after m v / f. It then stays at
// rest against smaller forces.
TEST(Friction, OfAJointStopsItAndHoldsIt) {
  LinkSpec link = link_of(PrismaticJoint{{1, 0, 0}});
  link.forces = {JointForces{}};
  link.forces[0].friction = 3.0;
  OneJoint j = make_joint(link, {-1.4, 0, 0});
  must(j.world.set_joint_state(j.id, 0, 0, 0.0, 1.0));
  const double deceleration = 3.0 / 2.0 + 1.4;
  const int steps = static_cast<int>(1.0 / deceleration / kDt);
  for (int i = 0; i < steps - 2; ++i) must(j.world.step(kDt));
  EXPECT_NEAR(j.world.joint_velocity(j.id, 0, 0), 1.0 - (steps - 2) * kDt * deceleration, 1e-9);
  for (int i = 0; i < 500; ++i) must(j.world.step(kDt));
  EXPECT_NEAR(j.world.joint_position(j.id, 0, 0), 0.5 / deceleration, 1e-3);
  EXPECT_NEAR(j.world.joint_velocity(j.id, 0, 0), 0.0, 1e-15);
}

TEST(Friction, InfiniteLocksAJointAlsoInImpacts) {
  LinkSpec link = link_of(RevoluteJoint{{0, 1, 0}});
  link.forces = {JointForces{}};
  link.forces[0].friction = JointForces::kNever;
  OneJoint j = make_joint(link, {0, 0, -9.81});
  ColliderDesc box;
  box.shape = Box{{0.3, 0.1, 0.02}};
  must(j.world.add_collider(j.body, box));
  add_dynamic(j.world, {.shape = Sphere{0.05},
                        .density = 8000,
                        .pose = SE3(Vec3{0.25, 0, 0.3}),
                        .velocity = {{}, {0, 0, -10}},
                        .continuous = true});
  bool hit = false;
  for (int i = 0; i < 100; ++i) {
    must(j.world.step(kDt));
    hit = hit || !j.world.contact_events().empty();
    ASSERT_NEAR(j.world.joint_position(j.id, 0, 0), 0.0, 1e-5);  // position correction
  }
  EXPECT_TRUE(hit);
}

// A link whose centre of mass is 0.2 m from a horizontal axis: T = 2 pi sqrt(I / (m g l)) for small
// amplitudes.
TEST(Pendulum, SwingsWithItsPeriod) {
  LinkSpec link;
  link.joint = RevoluteJoint{};
  link.T_parent_joint = SE3(Mat3{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {});
  const double l = 0.2, m = 1.5;
  link.inertia = Inertia(m, Vec3{0.01, 0.01, 0.01}).Xform(SE3(Vec3{0, l, 0}));  // centre at y = -l
  OneJoint j = make_joint(link, {0, 0, -9.81});
  must(j.world.set_joint_state(j.id, 0, 0, 0.02, 0.0));
  const double expected = 2 * kPi * std::sqrt((0.01 + m * l * l) / (m * 9.81 * l));
  double previous = 0.02, first = 0.0, last = 0.0;
  int crossings = 0;
  for (int i = 1; i <= 10000; ++i) {
    must(j.world.step(kDt));
    const double q = j.world.joint_position(j.id, 0, 0);
    ASSERT_LT(std::fabs(q), 0.0205);
    if (previous > 0.0 && q <= 0.0) {
      last = i * kDt;
      if (crossings++ == 0) first = last;
    }
    previous = q;
  }
  ASSERT_GT(crossings, 5);
  EXPECT_NEAR((last - first) / (crossings - 1), expected, 0.002 * expected);
}

TEST(Joint, DampingAndArmatureEnterAsWritten) {
  LinkSpec link = link_of(PrismaticJoint{});  // mass 2 kg
  link.armature = 3.0;
  link.damping = 10.0;  // decay rate 10 / 5 per second
  OneJoint j = make_joint(link);
  must(j.world.set_joint_state(j.id, 0, 0, 0.0, 1.0));
  for (int i = 0; i < 1000; ++i) must(j.world.step(kDt));
  EXPECT_NEAR(j.world.joint_velocity(j.id, 0, 0), std::exp(-2.0), 1e-3);
}

// A link stays on its axis, however strong an impact is.
TEST(Joint, NeverComesApart) {
  OneJoint j = make_joint(rod_link(0.0, 0.5), {0, 0, -9.81});
  ColliderDesc box;
  box.shape = Box{{0.05, 0.05, 0.05}};
  box.T_body_shape = SE3(Vec3{0.1, 0, 0});
  must(j.world.add_collider(j.body, box));
  for (int i = 0; i < 300; ++i) {
    if (i % 50 == 0) {
      add_dynamic(j.world, {.shape = Sphere{0.05},
                            .density = 8000,
                            .pose = SE3(Vec3{-0.1, 0.02, 1.0 + i * 0.01}),
                            .velocity = {{}, {0, 0, -10}}});
    }
    must(j.world.apply_impulse(j.body, {100, 0.1, -200}, {0.2, 0, 0.5}));
    must(j.world.step(kDt));
    const SE3 T = j.world.pose(j.body);
    ASSERT_EQ(T.position().x, 0.0);
    ASSERT_NEAR(T.position().z, 0.5, 1e-15);
    ASSERT_NEAR(T.rotation().cz.y, 1.0, 1e-15);
  }
}

TEST(Joint, AnImpulseActsThroughTheReducedInertia) {
  OneJoint j = make_joint(link_of(CylindricalJoint{}));
  must(j.world.apply_impulse(j.body, {0, 3, 4}, {0.5, 0, 0}));
  EXPECT_NEAR(j.world.joint_velocity(j.id, 0, 0), 4.0 / 2.0, 1e-15);
  EXPECT_NEAR(j.world.joint_velocity(j.id, 0, 1), 0.5 * 3 / 0.02, 1e-12);
}

TEST(Joint, ALinkFixedToTheWorldDoesNotMove) {
  LinkSpec fixed, swinging = link_of(RevoluteJoint{{1, 0, 0}});
  fixed.T_parent_joint = SE3(Vec3{1, 2, 3});
  swinging.parent = 0;
  swinging.T_parent_joint = SE3(Vec3{0, 0.3, 0});
  swinging.inertia = Inertia(1.0, Vec3{1, 1, 1}).Xform(SE3(Vec3{0, 0.5, 0}));
  World world;
  const ArticulationId id = must(world.create_articulation({model_of({fixed, swinging})}));
  for (int i = 0; i < 100; ++i) must(world.step(kDt));
  EXPECT_EQ(world.pose(world.link_body(id, 0)), SE3(Vec3{1, 2, 3}));
  EXPECT_GT(std::fabs(world.joint_velocity(id, 1, 0)), 0.1);
  EXPECT_FALSE(world.apply_impulse(world.link_body(id, 0), {1, 0, 0}, {}));
}

// A ball hits a free rod: the angular momentum about the rod's axis and the momentum along it are
// conserved.
TEST(Joint, ABallAndAFreeRodExchangeMomentum) {
  World world({.gravity = {}});
  const Material bouncy{0.2, 0.7, 0.0};
  const Rod rod = add_rod(world, 0.0, 0.09, 1, 0.0, bouncy);
  const BodyId ball = add_ball(world, {0.1, 0.005, 0.09 - 0.0665}, {-8, 0.5, 0}, bouncy);
  const Inertia J = solid_inertia(Sphere{kBallRadius}, kBallDensity);
  const auto about_axis = [&] {
    const SE3 T = world.pose(ball);
    const Vec3 v = T.rotate(world.velocity(ball).v), w = T.rotate(world.velocity(ball).w);
    const Vec3 L = J.rotational().xx * w + J.mass() * cross(T.position() - Vec3{0, 0, 0.09}, v);
    return L.y + 0.0015 * world.joint_velocity(rod.articulation, 0, 1);
  };
  const auto along = [&] {
    const SE3 T = world.pose(ball);
    return J.mass() * T.rotate(world.velocity(ball).v).y +
           1.5 * world.joint_velocity(rod.articulation, 0, 0);
  };
  const double L = about_axis(), p = along();
  for (int i = 0; i < 25; ++i) must(world.step(kDt));
  EXPECT_GT(std::fabs(world.joint_velocity(rod.articulation, 0, 1)), 1.0);
  EXPECT_NEAR(about_axis(), L, 1e-4 * std::fabs(L));  // position correction changes the arm
  EXPECT_NEAR(along(), p, 1e-9);
}

}  // namespace
}  // namespace vp::test
