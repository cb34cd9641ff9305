// Efforts along joints; reactions with bodies that rest on links, hit them or are restored;
// accelerations of points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "joint_reactions_rig.h"
#include "random.h"
#include "trees.h"
#include "vphysics/assert.h"

namespace vp::test {
namespace {

// The drive's effort is its force law at the end-of-step velocity.
TEST(JointEffort, IsWhatTheDriveIsTold) {
  World world;
  auto links = hanging_chain(1, RevoluteJoint{{0, 1, 0}});
  links[0].armature = 0.02;
  const auto id = must(world.create_articulation({model_of(links)}));
  must(world.set_drive(id, 0, 0, {0.8, 0.1, 30.0, 0.5, 100.0}));
  const double dt = 0.002;
  for (int i = 0; i < 300; ++i) {
    const double q = world.joint_position(id, 0, 0), v = world.joint_velocity(id, 0, 0);
    must(world.apply_joint_force(id, 0, 0, 0.25));
    step(world, dt);
    const double w = world.joint_velocity(id, 0, 0);
    const double told = 30.0 * (0.8 - q - dt * w) + 0.5 * (0.1 - w) + 0.25;
    EXPECT_NEAR(world.joint_effort(id, 0, 0), told, 1e-9);
    // The rotor's armature takes its part of the torque.
    const JointForce joint = world.joint_reaction(id, 0);
    EXPECT_NEAR(joint.torque.y + 0.02 * (w - v) / dt, told, 1e-9);
  }
  must(world.set_drive(id, 0, 0, {0.8, 1e3, 0.0, 0.5, 3.0}));  // at its maximum force
  step(world, dt);
  EXPECT_NEAR(world.joint_effort(id, 0, 0), 3.0, 1e-12);
}

// A trunk on two driven legs falls on its feet: its motors reach their limit in the impact, in
// which they are part of the mass matrix at first, and never exceed it. Before and after they
// follow their force law.
TEST(JointEffort, OfAMotorKeepsItsLimitInAnImpact) {
  constexpr double kLimit = 12.0, kStiffness = 80.0, kDamping = 4.0;
  for (const double rate : {1000.0, 240.0, 60.0}) {
    SCOPED_TRACE(rate);
    World world;
    add_ground(world, Material{});
    std::vector<LinkSpec> links(3);
    links[0].joint = FreeJoint{};
    links[0].inertia = Inertia(6.0, Vec3{0.1, 0.2, 0.2});
    for (std::size_t k = 1; k < links.size(); ++k) {
      links[k].parent = 0;
      links[k].joint = RevoluteJoint{{0, 1, 0}};
      links[k].T_parent_joint = SE3(Vec3{k == 1 ? 0.2 : -0.2, 0, 0});
      links[k].inertia = Inertia(0.5, Vec3{0.005, 0.005, 0.001}).InvXform(SE3(Vec3{0, 0, -0.15}));
      links[k].armature = 0.01;
    }
    const auto id = must(world.create_articulation({model_of(links)}));
    std::vector<double> q = world.model(id)->zero_coordinates();
    q[2] = 0.6;
    must(world.set_joint_states(id, q, std::vector<double>(8)));
    for (int l = 1; l < 3; ++l) {
      for (const double y : {-0.2, 0.2}) {
        ColliderDesc foot;
        foot.shape = Sphere{0.03};
        foot.T_body_shape = SE3(Vec3{l == 1 ? 0.25 : -0.25, y, -0.3});
        must(world.add_collider(world.link_body(id, l), foot));
      }
      must(world.set_drive(id, l, 0, {0.0, 0.0, kStiffness, kDamping, kLimit}));
    }
    const double dt = 1.0 / rate;
    int at_limit = 0, below = 0;
    for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) {
      const double before = world.joint_position(id, 1, 0);
      step(world, dt);
      const double effort = world.joint_effort(id, 1, 0), v = world.joint_velocity(id, 1, 0);
      EXPECT_LE(std::fabs(effort), kLimit + 1e-9);
      const double told = kStiffness * (-before - dt * v) - kDamping * v;
      EXPECT_NEAR(effort, std::clamp(told, -kLimit, kLimit), 2e-3 * kLimit);
      ++(std::fabs(effort) > kLimit - 1e-9 ? at_limit : below);
    }
    std::printf("%g Hz: %d steps at the limit, %d below\n", rate, at_limit, below);
    EXPECT_GT(at_limit, 0);
    EXPECT_GT(below, 0);
  }
}

// Motors, springs, friction, damping and stops of a moving tree: the efforts equal those of inverse
// dynamics, and the components of the reactions along the joints' axes, to first order in dt.
TEST(JointEffort, IsThatOfInverseDynamicsAndOfTheReaction) {
  double before_dynamics = 0.0, before_axis = 0.0;
  for (const double dt : {1e-3, 5e-4, 2.5e-4}) {
    auto links = hanging_chain(5, RevoluteJoint{{0, 1, 0}});
    for (std::size_t l = 0; l < links.size(); ++l) {
      links[l].joint = RevoluteJoint{l % 2 == 0 ? Vec3{0, 1, 0} : Vec3{1, 0, 0}};
      links[l].armature = 0.01;
      links[l].damping = 0.02;
      JointForces f;
      f.stiffness = 2.0;
      f.friction = l == 1 ? 0.05 : 0.0;
      links[l].forces = {f};
    }
    const Model model = model_of(links);
    World world;
    const auto id = must(world.create_articulation({model}));
    must(world.set_joint_states(id, std::vector<double>{.5, -.4, .3, .6, -.2},
                                std::vector<double>{1, 2, -1, 3, 2}));
    for (int l = 0; l < 5; ++l) must(world.set_drive(id, l, 0, {0.3, 0, 5.0, 0.1, 2.0}));
    step(world, dt, static_cast<int>(std::lround(0.02 / dt)));
    const auto q = copied(world.coordinates(id)), v = copied(world.velocities(id));
    step(world, dt);
    const auto w = copied(world.velocities(id));
    std::vector<double> a(5), tau(5);
    for (std::size_t i = 0; i < 5; ++i) a[i] = (w[i] - v[i]) / dt;
    Data data(model);
    inverse_dynamics<double>(model, data, q, v, a, {.gravity = kGravity}, tau);
    double dynamics = 0.0, axis = 0.0;
    for (int l = 0; l < 5; ++l) {
      const auto i = static_cast<std::size_t>(l);
      const double effort = world.joint_effort(id, l, 0);
      dynamics = std::max(dynamics, std::fabs(effort - (tau[i] - 0.02 * v[i])));
      const Vec3 along =
          world.pose(world.link_body(id, l)).rotate(std::get<RevoluteJoint>(links[i].joint).axis);
      const double felt = dot(along, world.joint_reaction(id, l).torque);
      axis = std::max(axis, std::fabs(effort - 0.01 * a[i] - felt));
    }
    std::printf("efforts at %.1e s: %.2e N m off inverse dynamics, %.2e off reactions\n", dt,
                dynamics, axis);
    if (before_axis > 0.0) {
      EXPECT_GT(before_dynamics / dynamics, 1.7);
      EXPECT_GT(before_axis / axis, 1.7);
    }
    before_dynamics = dynamics;
    before_axis = axis;
  }
}

// In sub-steps, without friction, so that contacts_of() has the full impulses: a box falls on a
// plate on springs and slides off.
TEST(JointReaction, HasTheLoadOfABodyOnALink) {
  LinkSpec plate;
  plate.joint = PrismaticJoint{{0, 0, 1}};
  plate.inertia = solid_inertia(Box{{0.5, 0.5, 0.05}}, 200.0);
  JointForces spring;
  spring.stiffness = 1e5;
  plate.forces = {spring};
  plate.damping = 300.0;
  for (const int sub_steps : {0, 1, 7}) {
    WorldDesc desc;
    desc.sub_steps = sub_steps;
    World world(desc);
    const auto id = must(world.create_articulation({model_of({plate})}));
    const Material smooth{0.0, 0.3, 0.0};
    const BodyId body = world.link_body(id, 0);
    must(world.add_collider(body, collider_of(Box{{0.5, 0.5, 0.05}}, smooth)));
    const BodyId box = add_dynamic(
        world, {.shape = Box{{0.1, 0.1, 0.1}}, .material = smooth, .pose = SE3({0.1, 0, 0.3})});
    double worst = 0.0, contact = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const std::vector<Momentum> before = momenta(world, id);
      const double v = world.joint_velocity(id, 0, 0);
      must(world.apply_force(body, {1, 2, 3}));
      step(world, 0.001);
      const Balance balance = balance_of(world, id, before, {{1, 2, 3}}, 0.001);
      worst = std::max(worst, balance.off / balance.size);
      contact = std::max(contact, balance.contact);
      // The effort equals the reaction's component along the joint: the plate does not rotate.
      const double effort = world.joint_effort(id, 0, 0);
      EXPECT_NEAR(effort, world.joint_reaction(id, 0).force.z, 1e-7 * balance.size) << i << v;
    }
    const JointForce joint = world.joint_reaction(id, 0);
    const double mass = plate.inertia.mass() + world.inertia(box).mass();
    std::printf("%d sub-steps: balance %.1e, contacts up to %.0f N; at rest %.6f of the weight\n",
                sub_steps, worst, contact, (joint.force.z + 3.0) / (mass * kG));
    EXPECT_GT(contact, 2000.0);
    EXPECT_LT(worst, 1e-6);
    EXPECT_NEAR((joint.force.z + 3.0) / (mass * kG), 1.0, 1e-5);
    // The moment of a box beside the centre.
    const double arm = world.pose(box).position().x;
    EXPECT_NEAR(joint.torque.y, -arm * kG * world.inertia(box).mass(), 1e-3);
  }
}

// A ball bounces off a locked plate in the middle of a step; a rod's foot hits another ball.
TEST(JointReaction, HasImpactsWithinTheStep) {
  LinkSpec plate;
  plate.joint = PrismaticJoint{{1, 0, 0}};
  plate.inertia = solid_inertia(Box{{0.5, 0.5, 0.05}}, 200.0);
  JointForces locked;
  locked.friction = JointForces::kNever;
  plate.forces = {locked};
  World world;
  const auto id = must(world.create_articulation({model_of({plate})}));
  const Material hard{0.3, 0.9, 0.01};
  must(world.add_collider(world.link_body(id, 0), collider_of(Box{{0.5, 0.5, 0.05}}, hard)));
  const BodyId ball = add_ball(world, {0.2, 0, 0.5}, {0, 0.4, 0}, hard);
  const double mass = world.inertia(ball).mass(), dt = 0.001;
  double hardest = 0.0;
  for (int i = 0; i < 600; ++i) {
    const Vec3 before = world.velocity_world(ball).linear;
    step(world, dt);
    const Vec3 to_ball = mass * (world.velocity_world(ball).linear - before - dt * kGravity);
    const Vec3 expected = (1.0 / dt) * to_ball - plate.inertia.mass() * kGravity;
    EXPECT_LT(norm(world.joint_reaction(id, 0).force - expected), 1e-9 * norm(expected));
    hardest = std::max(hardest, norm(to_ball) / dt);
  }
  EXPECT_GT(hardest, 100.0);
}

// Rods of a table; those far from every body are remote and are not processed.
TEST(JointReaction, OfRodsThatNothingIsNear) {
  World world;
  const Rod rod = add_rod(world, 0.1, 0.08, 3, 0.2, {0.4, 0.3, 0.0});
  add_ball(world, {2.0, 0, 1.0}, {}, {0.4, 0.3, 0.0});
  must(world.set_drive(rod.articulation, 0, 0, {0.05, 0, 200, 20, 50}));
  must(world.set_drive(rod.articulation, 0, 1, {2.0, 0, 2, 0.1, 5}));
  for (int i = 0; i < 300; ++i) {
    const std::vector<Momentum> before = momenta(world, rod.articulation);
    step(world, 0.001);
    const JointForce joint = world.joint_reaction(rod.articulation, 0);  // while it is remote
    EXPECT_NEAR(joint.force.y, world.joint_effort(rod.articulation, 0, 0), 1e-9);
    EXPECT_NEAR(joint.torque.y, world.joint_effort(rod.articulation, 0, 1), 1e-9);
    const Balance balance = balance_of(world, rod.articulation, before, {{}}, 0.001);
    EXPECT_LT(balance.off, 1e-9);
  }
}

// Joints with several degrees of freedom, and user forces along them.
TEST(JointReaction, OfAFreeRootIsWhatActsAlongIt) {
  World world;
  const Walker walker = add_walker(world, {0, 0, 5.0}, kRough);
  const SE3 before = world.pose(world.link_body(walker.id, 0));
  for (int k = 0; k < 6; ++k) must(world.apply_joint_force(walker.id, 0, k, 1.0 + k));
  step(world, 0.001);
  const JointForce joint = world.joint_reaction(walker.id, 0);
  EXPECT_LT(norm(joint.torque - before.rotate({1, 2, 3})), 1e-9);
  EXPECT_LT(norm(joint.force - before.rotate({4, 5, 6})), 1e-9);
  EXPECT_NEAR(world.joint_effort(walker.id, 0, 4), 5.0, 1e-12);
  step(world, 0.001);
  EXPECT_EQ(norm(world.joint_reaction(walker.id, 0).force), 0.0);
}

TEST(JointReaction, OfABallHasNoTorqueThroughIt) {
  double before = 0.0;
  for (const double dt : {2e-3, 1e-3}) {
    World world;
    const auto id = must(world.create_articulation({model_of(hanging_chain(1, BallJoint{}))}));
    must(world.set_joint_states(id, std::vector<double>{0.6, 0, 0, 0.8}, {{1.0, 2.0, 5.0}}));
    double worst = 0.0;
    for (int i = 0; i < static_cast<int>(0.4 / dt); ++i) {
      step(world, dt);
      worst = std::max(worst, norm(world.joint_reaction(id, 0).torque));
    }
    std::printf("ball at %.0e s: %.2e N m\n", dt, worst);
    if (before > 0.0) {
      EXPECT_GT(before / worst, 1.8);  // measured 2.0
    }
    before = worst;
  }
  EXPECT_LT(before, 3e-3);  // measured 1.8e-3, of 0.5 N m of weight
}

// Reactions of the last step stay until the next step, whatever is set afterwards. A snapshot does
// not include them.
TEST(JointReaction, StaysUntilTheNextStepAndIsZeroAfterRestore) {
  World world;
  const auto id =
      must(world.create_articulation({model_of(hanging_chain(2, RevoluteJoint{{0, 1, 0}}))}));
  const BodyId tip = world.link_body(id, 1);
  must(world.set_drive(id, 0, 0, {0.4, 0, 10, 1, 10}));
  EXPECT_EQ(norm(world.joint_reaction(id, 0).force), 0.0);
  EXPECT_EQ(world.joint_effort(id, 0, 0), 0.0);
  EXPECT_EQ(norm(world.acceleration_at(tip, {})), 0.0);
  step(world, 0.001, 50);
  std::vector<std::byte> bytes;
  world.snapshot(bytes);
  World other = std::move(world);
  for (const int change : {0, 1, 2}) {
    must(other.restore(bytes));
    EXPECT_EQ(norm(other.joint_reaction(id, 1).force), 0.0);
    EXPECT_EQ(other.joint_effort(id, 0, 0), 0.0);
    EXPECT_EQ(norm(other.acceleration_at(tip, {})), 0.0);
    step(other, 0.001);
    World same;
    (void)same.create_articulation({model_of(hanging_chain(2, RevoluteJoint{{0, 1, 0}}))});
    must(same.restore(bytes));
    step(same, 0.001);
    const JointForce expected = same.joint_reaction(id, 1);
    EXPECT_GT(norm(expected.force), 1.0);
    if (change == 0) must(other.apply_impulse(tip, {1, 2, 3}, {0, 0, -0.3}));
    if (change == 1) must(other.set_joint_state(id, 0, 0, 1.0, 2.0));
    if (change == 2) must(other.set_joint_states(id, {{1.0, 1.0}}, {{3.0, 3.0}}));
    EXPECT_EQ(other.joint_reaction(id, 1).force, expected.force);
    EXPECT_EQ(other.joint_reaction(id, 1).torque, expected.torque);
    EXPECT_EQ(other.joint_effort(id, 0, 0), same.joint_effort(id, 0, 0));
  }
  // Queries change no state.
  World asked, not_asked;
  for (World* w : {&asked, &not_asked}) {
    (void)w->create_articulation({model_of(hanging_chain(2, RevoluteJoint{{0, 1, 0}}))});
    must(w->restore(bytes));
    for (int i = 0; i < 20; ++i) {
      step(*w, 0.001);
      if (w == &asked) (void)w->joint_reaction(id, 0);
    }
  }
  EXPECT_EQ(asked.state_hash(), not_asked.state_hash());
}

// An invalid argument asserts. If the handler continues, the result is zero.
TEST(JointReaction, OfNoSuchLinkIsZero) {
  static int assertions = 0;
  assertions = 0;
  const AssertHandler before =
      set_assert_handler([](const char*, const char*, int) { ++assertions; });
  World world;
  const auto id =
      must(world.create_articulation({model_of(hanging_chain(2, RevoluteJoint{{0, 1, 0}}))}));
  const BodyId link = world.link_body(id, 1), body = add_dynamic(world, {});
  step(world, 0.001);
  for (const int none : {-1, 2}) EXPECT_EQ(norm(world.joint_reaction(id, none).force), 0.0);
  EXPECT_EQ(world.joint_effort(id, 0, 1), 0.0);
  EXPECT_EQ(norm(world.acceleration_at(body, {})), 0.0);
  must(world.destroy_articulation(id));
  EXPECT_EQ(norm(world.joint_reaction(id, 0).force), 0.0);
  EXPECT_EQ(world.joint_effort(id, 0, 0), 0.0);
  EXPECT_EQ(norm(world.acceleration_at(link, {})), 0.0);
  set_assert_handler(before);
#if defined(VP_ASSERTIONS) || !defined(NDEBUG)
  EXPECT_EQ(assertions, 7);
#endif
}

// An accelerometer: at rest it reads the weight, in free fall zero, on a wheel the centripetal
// acceleration.
TEST(AccelerationAt, IsTheChangeOfVelocityOfThePoint) {
  World world;
  const Walker walker = add_walker(world, {0, 0, 5.0}, kRough);
  const BodyId trunk = world.link_body(walker.id, 0);
  step(world, 0.001);
  EXPECT_LT(norm(world.acceleration_at(trunk, {0.3, 0.1, 5.0}) - kGravity), 1e-9);

  World turning;
  LinkSpec wheel;
  wheel.joint = RevoluteJoint{{0, 0, 1}};
  wheel.inertia = solid_inertia(Cylinder{0.1, 0.5}, 100.0);
  const auto id = must(turning.create_articulation({model_of({wheel})}));
  const BodyId body = turning.link_body(id, 0);
  must(turning.set_joint_state(id, 0, 0, 0.3, 7.0));
  const double dt = 0.001;
  for (int i = 0; i < 20; ++i) {
    const Vec3 in_wheel{0.5, 0, 0.1};
    const Vec3 before = turning.velocity_at(body, turning.pose(body) * in_wheel);
    step(turning, dt);
    const Vec3 point = turning.pose(body) * in_wheel;
    const Vec3 change = (1.0 / dt) * (turning.velocity_at(body, point) - before);
    EXPECT_LT(norm(turning.acceleration_at(body, point) - change), 1e-9);
    const Vec3 halfway = Exp(Vec3{0, 0, -0.5 * dt * 7.0}).matrix() * Vec3{point.x, point.y, 0};
    EXPECT_LT(norm(change - (-49.0) * halfway), 1e-4);
  }
}

}  // namespace
}  // namespace vp::test
