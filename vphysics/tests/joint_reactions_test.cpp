// Joint reactions of articulations in a step, against statics, closed forms, and the momentum
// balance of each link from public queries.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "joint_reactions_rig.h"
#include "random.h"
#include "trees.h"

namespace vp::test {
namespace {

// Every kind of joint, locked: each carries the weight and moment of the links beyond it. The
// solver stops when all velocities are below a limit, so the links are not completely still, and
// the balance includes their change of momentum. Along the joints, the locks also act against the
// velocities that gravity gives before the solve: an error of dt squared.
TEST(JointReaction, OfWhatStandsIsStatics) {
  double before = 0.0;
  for (const double dt : {1e-3, 5e-4}) {
    Random random(11);
    double worst = 0.0, along = 0.0;
    for (int sample = 0; sample < 20; ++sample) {
      const Model loose = random_tree(random, 12);
      std::vector<LinkSpec> links;
      for (int l = 0; l < loose.links(); ++l) {
        LinkSpec link = loose.link(l);
        JointForces locked;
        locked.friction = JointForces::kNever;
        link.forces.assign(static_cast<std::size_t>(velocities_of(link.joint)), locked);
        links.push_back(link);
      }
      World world;
      const ArticulationId id = must(world.create_articulation({model_of(links)}));
      const State s = random_state(random, loose);
      const std::vector<double> zero(s.v.size());
      must(world.set_joint_states(id, s.q, zero));
      step(world, dt, 300);
      const std::vector<Momentum> was = momenta(world, id);
      const std::vector<double> v = copied(world.velocities(id));
      step(world, dt);
      const std::vector<Momentum> now = momenta(world, id);
      std::vector<Vec3> force(links.size()), moment(links.size());  // about the world's origin
      for (int l = loose.links(); l-- > 0;) {
        const auto i = static_cast<std::size_t>(l);
        const Vec3 weight = links[i].inertia.mass() * kGravity;
        force[i] += (1.0 / dt) * (now[i].linear - was[i].linear) - weight;
        moment[i] += (1.0 / dt) * (now[i].angular - was[i].angular) - cross(now[i].centre, weight);
        const JointForce joint = world.joint_reaction(id, l);
        const Vec3 at = world.pose(world.link_body(id, l)).position();
        worst = std::max({worst, norm(joint.force - force[i]),
                          norm(joint.torque - (moment[i] - cross(at, force[i])))});
        if (links[i].parent == kWorld) continue;
        force[static_cast<std::size_t>(links[i].parent)] += force[i];
        moment[static_cast<std::size_t>(links[i].parent)] += moment[i];
      }
      Data data(loose);
      std::vector<double> tau(s.v.size()), a = copied(world.velocities(id));
      for (std::size_t i = 0; i < a.size(); ++i) a[i] = (a[i] - v[i]) / dt;
      inverse_dynamics<double>(loose, data, world.coordinates(id), zero, a, {.gravity = kGravity},
                               tau);
      for (int l = 0; l < loose.links(); ++l) {
        for (int k = 0; k < velocities_of(links[static_cast<std::size_t>(l)].joint); ++k) {
          const auto i = static_cast<std::size_t>(loose.first_velocity(l) + k);
          along = std::max(along, std::fabs(world.joint_effort(id, l, k) - tau[i]));
        }
      }
    }
    std::printf("locked trees at %.0e s: %.1e N or N m off statics; %.1e along joints\n", dt, worst,
                along);
    EXPECT_LT(worst, 1e-7);  // measured 2.4e-8, of forces of 100 N: the residual motion
    EXPECT_LT(along, 1e-3);  // measured 2.4e-4, 6.1e-5
    if (before > 0.0) {
      EXPECT_GT(before / along, 3.5);
    }
    before = along;
  }
}

TEST(JointReaction, OfAHangingPendulumIsItsWeight) {
  World world;
  const auto id =
      must(world.create_articulation({model_of(hanging_chain(3, RevoluteJoint{{0, 1, 0}}))}));
  step(world, 0.001, 10);
  for (int l = 0; l < 3; ++l) {
    const JointForce joint = world.joint_reaction(id, l);
    EXPECT_LT(norm(joint.force - Vec3{0, 0, 0.5 * kG * (3 - l)}), 1e-9);
    EXPECT_LT(norm(joint.torque), 1e-9);
    EXPECT_EQ(world.joint_effort(id, l, 0), 0.0);
  }
}

// An arm of two bars, supported by drives. The weights act at the bars' centres.
TEST(JointReaction, OfAnArmThatDrivesHoldIsStatics) {
  World world;
  auto links = hanging_chain(2, RevoluteJoint{{0, 1, 0}});
  links[0].T_parent_joint = SE3(Vec3{0.3, -0.2, 1.0});
  const auto id = must(world.create_articulation({model_of(links)}));
  for (int l = 0; l < 2; ++l) must(world.set_drive(id, l, 0, {-0.7, 0, 400, 20, 1e9}));
  step(world, 0.002, 5000);
  const double weight = 0.5 * kG, a = world.joint_position(id, 0, 0),
               b = a + world.joint_position(id, 1, 0), half = 0.1;
  // Horizontal distances from each joint. A bar at an angle a from -z about y extends by -sin a of
  // its length.
  const double at_elbow = -half * std::sin(b), elbow = -2 * half * std::sin(a);
  const double at_shoulder = -half * std::sin(a) + elbow + at_elbow;
  const double torque[] = {-weight * at_shoulder, -weight * at_elbow};
  for (int l = 0; l < 2; ++l) {
    const JointForce joint = world.joint_reaction(id, l);
    EXPECT_LT(norm(joint.force - Vec3{0, 0, weight * (2 - l)}), 1e-9);
    EXPECT_LT(norm(joint.torque - Vec3{0, torque[l], 0}), 1e-9);
    EXPECT_NEAR(world.joint_effort(id, l, 0), torque[l], 5e-5);  // error of dt squared: 1.1e-5
    EXPECT_GT(std::fabs(torque[l]), 0.3);
  }
}

// A swinging bar, against its equation of motion integrated in small steps: the error is of first
// order in dt.
TEST(JointReaction, OfASwingingPendulumIsCentripetalForceAndWeight) {
  constexpr double kLength = 0.2, kMass = 0.5, kStart = 1.2, kTime = 0.8;
  const Inertia J = bar(kMass, kLength);
  double before = 0.0;
  for (const double dt : {2e-3, 1e-3, 5e-4}) {
    World world;
    const auto id =
        must(world.create_articulation({model_of(hanging_chain(1, RevoluteJoint{{0, 1, 0}}))}));
    must(world.set_joint_state(id, 0, 0, kStart, 0.0));
    const int count = static_cast<int>(std::lround(kTime / dt));
    double worst = 0.0, angle = kStart, speed = 0.0;
    const auto pull = [&](double x) {
      return -kMass * kG * 0.5 * kLength / J.rotational().yy * std::sin(x);
    };
    for (int i = 0; i < count; ++i) {
      step(world, dt);
      constexpr int kFine = 40;
      for (int k = 0; k < kFine; ++k) {  // leapfrog: its midpoint is that of the step
        const double h = dt / kFine;
        speed += 0.5 * h * pull(angle);
        angle += h * speed;
        speed += 0.5 * h * pull(angle);
        if (k != kFine / 2 - 1) continue;
        const Vec3 out{-std::sin(angle), 0, -std::cos(angle)};
        const Vec3 onward{-std::cos(angle), 0, std::sin(angle)};
        const Vec3 centripetal = (-0.5 * kLength * speed * speed) * out;
        const Vec3 a = centripetal + (0.5 * kLength * pull(angle)) * onward;
        const Vec3 expected = kMass * (a - kGravity);
        worst = std::max(worst, norm(world.joint_reaction(id, 0).force - expected));
      }
      EXPECT_LT(norm(world.joint_reaction(id, 0).torque), 1e-9);  // no torque at the pivot
    }
    std::printf("pendulum at %.1e s: force off by %.2e N, %.2f times less\n", dt, worst,
                before / worst);
    if (before > 0.0) {
      EXPECT_NEAR(before / worst, 2.0, 0.1);  // measured 2.01, 2.00
    }
    before = worst;
  }
}

// Foot contacts, drives, gravity: the hips carry the trunk's weight.
TEST(JointReaction, OfAStandingWalkerIsTheWeightOfWhatIsAbove) {
  World world;
  add_ground(world, kRough);
  const Walker walker = add_walker(world, {0, 0, Walker::kHeight}, kRough);
  step(world, 0.001, 4000);
  const Model& model = *world.model(walker.id);
  Vec3 hips, knees;
  for (int leg = 0; leg < 4; ++leg) {
    hips -= world.joint_reaction(walker.id, 1 + 2 * leg).force;
    knees -= world.joint_reaction(walker.id, 2 + 2 * leg).force;
  }
  const double trunk = kG * model.link(0).inertia.mass(), thighs = 4 * kG;
  std::printf("hips carry %.6f N of %.6f N\n", hips.z, trunk);
  EXPECT_LT(norm(hips - Vec3{0, 0, trunk}), 1e-6 * trunk);  // measured 6.4e-8
  EXPECT_LT(norm(knees - Vec3{0, 0, trunk + thighs}), 1e-6 * trunk);
  EXPECT_EQ(norm(world.joint_reaction(walker.id, 0).force), 0.0);  // a floating root
  EXPECT_EQ(norm(world.joint_reaction(walker.id, 0).torque), 0.0);
}

// A tree of any joints with motors, stops, springs, friction and damping, and with spheres that
// fall on the ground and bounce.
ArticulationId add_rough_tree(World& world, Random& random, bool floating, const Material& m) {
  const Model loose = random_tree(random, 10);
  std::vector<LinkSpec> links;
  for (int l = 0; l < loose.links(); ++l) {
    LinkSpec link = loose.link(l);
    if (link.parent == kWorld && l > 0) link.parent = 0;
    if (l == 0) link.joint = floating ? Joint{FreeJoint{}} : Joint{RevoluteJoint{{1, 0, 0}}};
    if (l == 0 && floating) link.armature = link.damping = 0.0;
    if (l == 0) link.T_parent_joint = SE3(Vec3{0, 0, 1.0});
    const auto n = static_cast<std::size_t>(velocities_of(link.joint));
    const bool has_coordinates = velocities_of(link.joint) == coordinates_of(link.joint);
    for (std::size_t k = 0; k < n && (l > 0 || !floating); ++k) {
      JointForces f;
      f.friction = l % 3 == 0 ? 0.3 : 0.0;
      if (has_coordinates && l % 2 == 0) f.stiffness = 5.0;
      if (has_coordinates) f.lower = -0.6, f.upper = 0.8;
      link.forces.push_back(f);
    }
    links.push_back(link);
  }
  const auto id = must(world.create_articulation({model_of(links)}));
  for (int l = 0; l < loose.links(); ++l) {
    must(world.add_collider(world.link_body(id, l), collider_of(Sphere{0.15}, m)));
  }
  return id;
}

TEST(JointReaction, BalancesTheMomentumOfEachLink) {
  for (const bool floating : {false, true}) {
    Random random(floating ? 5 : 3);
    double worst = 0.0, worst_root = 0.0, contact = 0.0;
    for (int sample = 0; sample < 5; ++sample) {
      World world;
      add_ground(world, {0.6, 0.4, 0.02});
      const auto id = add_rough_tree(world, random, floating, {0.6, 0.4, 0.02});
      const auto n = world.velocities(id).size();
      const int count = world.model(id)->links();
      std::vector<JointDrive> drives(n);
      for (JointDrive& d : drives) d = {0, random.uniform(-1, 1), 0, 2.0, 8.0};
      for (std::size_t k = 0; k < 6 && floating; ++k) drives[k] = {};
      must(world.set_drives(id, drives));
      for (int i = 0; i < 200; ++i) {
        const double dt = i % 7 == 0 ? 0.004 : 0.002;
        const int pushed = static_cast<int>(random.word() % static_cast<unsigned>(count));
        std::vector<Vec3> user(static_cast<std::size_t>(count));
        user[static_cast<std::size_t>(pushed)] = random.in_cube(20.0);
        const BodyId body = world.link_body(id, pushed);
        must(world.apply_force(body, user[static_cast<std::size_t>(pushed)]));
        must(world.apply_torque(body, random.in_cube(2.0)));
        const std::vector<Momentum> before = momenta(world, id);
        step(world, dt);
        const Balance all = balance_of(world, id, before, user, dt);
        const Balance inner = balance_of(world, id, before, user, dt, false);
        worst = std::max(worst, inner.off / inner.size);
        worst_root = std::max(worst_root, all.off / all.size);
        contact = std::max(contact, all.contact);
      }
    }
    std::printf("%s: balance of links %.1e, of roots too %.1e; contacts up to %.0f N\n",
                floating ? "floating" : "fixed", worst, worst_root, contact);
    EXPECT_GT(contact, 500.0);
    EXPECT_LT(worst, 1e-9);
    if (!floating) {
      EXPECT_LT(worst_root, 1e-9);
    }
  }
}

// Angular momentum balance of each link about its centre of mass, for swinging trees: to first
// order in dt.
TEST(JointReaction, BalancesAngularMomentumToTheOrderOfTheStep) {
  double before = 0.0;
  for (const double dt : {2e-3, 1e-3, 5e-4}) {
    Random random(21);
    double worst = 0.0;
    for (int sample = 0; sample < 10; ++sample) {
      World world;
      const Model model = random_tree(random, 8);
      const auto id = must(world.create_articulation({model}));
      const State s = random_state(random, model);
      must(world.set_joint_states(id, s.q, s.v));
      step(world, dt, 10);
      const std::vector<Momentum> was = momenta(world, id);
      std::vector<Vec3> origin;
      for (int l = 0; l < model.links(); ++l) {
        origin.push_back(world.pose(world.link_body(id, l)).position());
      }
      step(world, dt);
      const std::vector<Momentum> now = momenta(world, id);
      std::vector<Vec3> torque(now.size());
      for (int l = 0; l < model.links(); ++l) {
        const auto i = static_cast<std::size_t>(l);
        const JointForce joint = world.joint_reaction(id, l);
        torque[i] += joint.torque + cross(origin[i] - was[i].centre, joint.force);
        if (model.link(l).parent == kWorld) continue;
        const auto p = static_cast<std::size_t>(model.link(l).parent);
        torque[p] -= joint.torque + cross(origin[i] - was[p].centre, joint.force);
      }
      for (std::size_t i = 0; i < now.size(); ++i) {
        const auto spin = [](const Momentum& m) { return m.angular - cross(m.centre, m.linear); };
        const Vec3 changed = (1.0 / dt) * (spin(now[i]) - spin(was[i]));
        worst = std::max(worst, norm(changed - torque[i]));
      }
    }
    std::printf("angular balance at %.1e s: %.2e N m off, %.2f times less\n", dt, worst,
                before / worst);
    if (before > 0.0) {
      EXPECT_GT(before / worst, 1.8);  // measured 2.13, 2.07
    }
    before = worst;
  }
}

// A tumbling tree in flight, with any joints: the sum of the joint forces on its trunk and its
// change of momentum equals gravity, about any point.
TEST(JointReaction, OfATumblingTreeLeavesNothingToItsRoot) {
  World world;
  const Walker walker = add_walker(world, {1e3, -2e3, 5.0}, kRough);
  std::vector<double> v(world.velocities(walker.id).size(), 0.7);
  must(world.set_joint_states(walker.id, walker.rest, v));
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    const BodyId trunk = world.link_body(walker.id, 0);
    const Momentum was = momenta(world, walker.id)[0];
    step(world, 1e-3);
    const Momentum now = momenta(world, walker.id)[0];
    Vec3 force = world.model(walker.id)->link(0).inertia.mass() * kGravity;
    for (int leg = 0; leg < 4; ++leg) force -= world.joint_reaction(walker.id, 1 + 2 * leg).force;
    worst = std::max(worst, norm(1e3 * (now.linear - was.linear) - force));
    EXPECT_EQ(norm(world.joint_reaction(walker.id, 0).force), 0.0);
    EXPECT_TRUE(world.contains(trunk));
  }
  std::printf("tumbling walker: trunk off by %.1e N\n", worst);
  EXPECT_LT(worst, 1e-7);
}

}  // namespace
}  // namespace vp::test
