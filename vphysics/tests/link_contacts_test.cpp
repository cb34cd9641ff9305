// Free bodies that rest on links, and links that rest on free bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "tree_scenes.h"
#include "vphysics/multibody/dynamics.h"
#include "vphysics/multibody/quantities.h"

namespace vp::test {
namespace {

LinkSpec link_of(const Joint& joint, const Shape& shape, double density) {
  LinkSpec link;
  link.joint = joint;
  link.inertia = solid_inertia(shape, density);
  return link;
}

const Box kPlate{{0.5, 0.5, 0.05}};
// A plate on one joint to the world, with its top at z = 0.
Plate add_plate(World& world, const Joint& joint, const Material& material,
                const JointForces& forces = {}) {
  LinkSpec link = link_of(joint, kPlate, 1000.0);
  link.T_parent_joint = SE3(Vec3{0, 0, -kPlate.half_extents.z});
  link.forces = {forces};
  const ArticulationId id = must(world.create_articulation({model_of({link})}));
  must(world.add_collider(world.link_body(id, 0), collider_of(kPlate, material)));
  return {id, world.link_body(id, 0)};
}

std::vector<BodyId> add_stack(World& world, int count, double half, const Vec3& foot) {
  std::vector<BodyId> stack;
  for (int i = 0; i < count; ++i) {
    stack.push_back(add_dynamic(world, {.shape = Box{{half, half, half}},
                                        .material = kRough,
                                        .pose = SE3(foot + Vec3{0, 0, half * (2 * i + 1)})}));
  }
  return stack;
}

// A motor lifts a stack. Each box stays where it was on the box below.
TEST(LinkContact, AStackStandsOnALift) {
  for (const double rate : kRates) {
    World world;
    const Plate lift = add_plate(world, PrismaticJoint{{0, 0, 1}}, kRough);
    must(world.set_drive(lift.id, 0, 0, {0, 0.5, 0, 1e6, 1e6}));
    const std::vector<BodyId> stack = add_stack(world, 10, 0.1, {});
    for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) must(world.step(1.0 / rate));
    const double top = world.pose(lift.body).position().z + kPlate.half_extents.z;
    EXPECT_NEAR(top, 1.0, 0.02) << rate;
    double sunk = 0.0, aside = 0.0;
    for (std::size_t i = 0; i < stack.size(); ++i) {
      const Vec3 x = world.pose(stack[i]).position();
      sunk = std::max(sunk, std::fabs(x.z - top - 0.1 * (2.0 * static_cast<double>(i) + 1.0)));
      aside = std::max(aside, std::hypot(x.x, x.y));
    }
    std::printf("%g Hz: %.2g m sunk, %.2g m aside\n", rate, sunk, aside);
    EXPECT_LT(sunk, 0.004) << rate;  // 1.2 mm at 60 Hz
    EXPECT_LT(aside, 0.002) << rate;
  }
}

// A free link behaves as a body: dropped between two boxes, all three rest as three boxes do.
TEST(LinkContact, AFreeLinkInAStackIsABodyInAStack) {
  const Box box{{0.1, 0.1, 0.1}};
  World bodies, links;
  std::vector<BodyId> twins[2];
  for (World* world : {&bodies, &links}) {
    std::vector<BodyId>& all = twins[world == &links];
    add_ground(*world, kRough);
    for (int i = 0; i < 3; ++i) {
      const Vec3 at{0.02 * i, -0.01 * i, 0.1 + 0.22 * i};
      if (world == &bodies || i != 1) {
        all.push_back(add_dynamic(*world, {.shape = box, .material = kRough, .pose = SE3(at)}));
        continue;
      }
      const Model model = model_of({link_of(FreeJoint{}, box, 1000.0)});
      const ArticulationId id = must(world->create_articulation({model}));
      must(world->add_collider(world->link_body(id, 0), collider_of(box, kRough)));
      must(world->set_joint_states(id, std::vector<double>{at.x, at.y, at.z, 0, 0, 0, 1},
                                   std::vector<double>(6)));
      all.push_back(world->link_body(id, 0));
    }
  }
  double apart = 0.0;
  for (int i = 0; i < 1000; ++i) {
    must(bodies.step(0.001));
    must(links.step(0.001));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 corner{0.1, 0.1, 0.1};
      apart = std::max(apart,
                       norm(bodies.pose(twins[0][k]) * corner - links.pose(twins[1][k]) * corner));
    }
  }
  std::printf("corners %.2g m apart at most\n", apart);
  EXPECT_LT(apart, 0.002);
}

// Sliding begins at the friction angle, with the acceleration g (sin a - mu cos a).
TEST(LinkContact, ABoxSlidesOnATiltedLinkAsItsFrictionSays) {
  const double mu = 0.5, critical = std::atan(mu);
  JointForces locked;
  locked.friction = std::numeric_limits<double>::infinity();
  for (const double share : {0.97, 1.2}) {
    World world;
    const Material m{mu, 0.0, 0.0};
    const double angle = share * critical;
    const Plate plate = add_plate(world, RevoluteJoint{{0, 1, 0}}, m, locked);
    must(world.set_joint_states(plate.id, std::vector<double>{angle}, std::vector<double>{0}));
    const SE3 T = world.pose(plate.body);
    const BodyId box =
        add_dynamic(world, {.shape = Box{{0.04, 0.04, 0.02}},
                            .material = m,
                            .pose = T * SE3(Vec3{-0.4, 0, kPlate.half_extents.z + 0.02})});
    const auto along = [&] { return inverse_times(T, world.pose(box).position()).x; };
    for (int i = 0; i < 100; ++i) must(world.step(0.001));
    const double x0 = along(),
                 v0 = dot(T.rotation().cx, world.pose(box).rotate(world.velocity(box).v));
    for (int i = 0; i < 400; ++i) must(world.step(0.001));
    const double x = along() - x0;
    if (share < 1.0) {
      EXPECT_LT(std::fabs(x), 1e-3);
      continue;
    }
    const double a = 9.81 * (std::sin(angle) - mu * std::cos(angle));
    std::printf("%.4f m, %.4f by the law\n", x, v0 * 0.4 + 0.5 * a * 0.16);
    EXPECT_NEAR(x, v0 * 0.4 + 0.5 * a * 0.16, 0.01 * 0.5 * a * 0.16);
  }
}

// On a belt at speed u, a box reaches u; a ball that starts at rest and then rolls without slip
// reaches 2/7 u.
TEST(LinkContact, ABeltOnALinkCarriesBoxesAndBalls) {
  const double u = 0.7, mu = 0.4;
  World world;
  const Material m{mu, 0.0, 0.0};
  LinkSpec link = link_of(PrismaticJoint{{0, 0, 1}}, kPlate, 1000.0);
  link.T_parent_joint = SE3(Vec3{0, 0, -kPlate.half_extents.z});
  const ArticulationId id = must(world.create_articulation({model_of({link})}));
  ColliderDesc belt = collider_of(kPlate, m);
  belt.surface_velocity = {u, 0, 0};
  must(world.add_collider(world.link_body(id, 0), belt));
  must(world.set_drive(id, 0, 0, {0, 0, 1e6, 1e5, 1e6}));
  const BodyId box = add_dynamic(
      world, {.shape = Box{{0.05, 0.05, 0.02}}, .material = m, .pose = SE3(Vec3{-0.4, 0.2, 0.02})});
  const BodyId ball = add_ball(world, {-0.4, -0.2, kBallRadius}, {}, m);
  const auto speed = [&](BodyId body) { return world.pose(body).rotate(world.velocity(body).v).x; };
  for (int i = 0; i < 30; ++i) must(world.step(0.001));  // the plate settles on its drive
  const double before = speed(box);
  for (int i = 0; i < 50; ++i) must(world.step(0.001));
  EXPECT_NEAR(speed(box) - before, mu * 9.81 * 0.05, 0.01 * mu * 9.81 * 0.05);
  for (int i = 0; i < 350; ++i) must(world.step(0.001));
  std::printf("box %.4f, ball %.4f of %.4f m/s\n", speed(box), speed(ball), 2.0 / 7.0 * u);
  EXPECT_NEAR(speed(box), u, 0.002 * u);
  EXPECT_NEAR(speed(ball), 2.0 / 7.0 * u, 0.005 * u);
}

struct Momenta {
  dse3 all;
  double energy;
};
// Momenta of a tree and of bodies, about the world's origin.
Momenta momenta_of(const World& world, ArticulationId id, const std::vector<BodyId>& bodies,
                   const Inertia& J) {
  const Model& model = *world.model(id);
  Data data(model);
  forward_kinematics<double>(model, data, world.coordinates(id), world.velocities(id));
  Momenta sum{momentum(model, data, Vec3{}), kinetic_energy(model, data)};
  for (const BodyId body : bodies) {
    const SE3 T = world.pose(body);
    const se3 V = world.velocity(body);
    const Vec3 p = J.mass() * T.rotate(V.v), L = T.rotate(J.rotational() * V.w);
    sum.all.m += L + cross(T.position(), p);
    sum.all.f += p;
    sum.energy += 0.5 * (J.mass() * dot(V.v, V.v) + dot(V.w, J.rotational() * V.w));
  }
  return sum;
}

// Boxes are thrown at a floating walker: total momentum is conserved, and energy does not grow.
TEST(LinkContact, OfThrownBoxesKeepsTheMomentumOfAll) {
  const Box shape{{0.05, 0.05, 0.05}};
  World world({.gravity = {}});
  const Walker walker = add_walker(world, {0, 0, 0}, kRough);
  for (int link = 1; link <= 8; ++link) must(world.set_drive(walker.id, link, 0, {}));
  std::vector<BodyId> boxes;
  for (const double x : {-0.25, 0.0, 0.2}) {
    boxes.push_back(add_dynamic(world, {.shape = shape,
                                        .material = kRough,
                                        .density = 2000.0,
                                        .pose = SE3(Vec3{x, 0.5, -0.3 + x}),
                                        .velocity = {{2, 1, 3}, {0.3, -3, 0.5}}}));
  }
  const Inertia J = solid_inertia(shape, 2000.0);
  const Momenta before = momenta_of(world, walker.id, boxes, J);
  long hits = 0;
  double linear = 0.0, angular = 0.0, energy = before.energy, gained = 0.0;
  for (int i = 0; i < 400; ++i) {
    must(world.step(0.001));
    hits += static_cast<long>(world.contact_events().size());
    const Momenta now = momenta_of(world, walker.id, boxes, J);
    linear = std::max(linear, norm(now.all.f - before.all.f));
    angular = std::max(angular, norm(now.all.m - before.all.m));
    gained = std::max(gained, now.energy - energy);
    energy = std::min(energy, now.energy);
  }
  std::printf("%ld events; momentum %.2g of %.3g, angular %.2g of %.3g; energy +%.2g of %.3g\n",
              hits, linear, norm(before.all.f), angular, norm(before.all.m), gained, before.energy);
  EXPECT_GT(hits, 2);
  EXPECT_LT(energy, 0.9 * before.energy);
  EXPECT_LT(linear, 1e-5 * norm(before.all.f));  // sub-steps solve bodies in single precision
  EXPECT_LT(angular, 1e-3 * norm(before.all.m));
  EXPECT_LT(gained, 1e-3 * before.energy);
}

// Four pillars of three boxes support a walker with 30 kg on its back.
TEST(LinkContact, AWalkerStandsOnPillarsUnderALoad) {
  for (const double rate : kRates) {
    World world;
    add_ground(world, kRough);
    std::vector<BodyId> boxes;
    for (const double x : {-0.25, 0.25}) {
      for (const double y : {-0.15, 0.15}) {
        for (const BodyId box : add_stack(world, 3, 0.06, {x, y, 0})) boxes.push_back(box);
      }
    }
    const double trunk = 0.36 + Walker::kHeight;
    const Walker walker = add_walker(world, {0, 0, trunk}, kRough);
    boxes.push_back(add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}},
                                        .material = kRough,
                                        .density = 30.0 / 0.008,
                                        .pose = SE3(Vec3{0, 0, trunk + 0.08 + 0.1})}));
    const auto run = [&](double seconds) {
      for (int i = 0; i < static_cast<int>(seconds * rate); ++i) must(world.step(1.0 / rate));
    };
    run(0.6);
    std::vector<Vec3> converged;
    for (const BodyId box : boxes) converged.push_back(world.pose(box).position());
    run(0.6);
    double drift = 0.0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      drift = std::max(drift, norm(world.pose(boxes[i]).position() - converged[i]));
    }
    std::printf("%g Hz: %.2g m in 0.6 s; the load at %.4f\n", rate, drift, converged.back().z);
    EXPECT_LT(drift, 0.002) << rate;
    EXPECT_NEAR(converged.back().z, trunk + 0.18, 0.03) << rate;  // its legs yield
  }
}

// A plate of 4 mm thickness supports a stack while continuous balls are shot at it: no ball passes
// it.
TEST(LinkContact, NoBallPassesALinkUnderALoad) {
  const Box sheet{{0.5, 0.5, 0.002}};
  World world;
  LinkSpec link = link_of(PrismaticJoint{{0, 0, 1}}, sheet, 8000.0);
  link.T_parent_joint = SE3(Vec3{0, 0, 1.0});
  const ArticulationId id = must(world.create_articulation({model_of({link})}));
  const BodyId plate = world.link_body(id, 0);
  must(world.add_collider(plate, collider_of(sheet, kRough)));
  must(world.set_drive(id, 0, 0, {0, 0, 1e5, 2e3, 1e6}));
  add_stack(world, 4, 0.08, {0, 0, 1.002});
  std::vector<BodyId> balls;
  for (int i = 0; i < 5; ++i) {
    balls.push_back(add_ball(world, {0.2 * (i - 2), 0.3, 0.5}, {}, {0.3, 0.5, 0.0}));
  }
  double highest = -1.0;
  for (int i = 0; i < 1000; ++i) {
    if (i % 100 == 0) {
      for (std::size_t k = 0; k < balls.size(); ++k) {
        must(world.set_pose(balls[k], SE3(Vec3{0.2 * (static_cast<double>(k) - 2), 0.3, 0.5})));
        must(world.set_velocity(balls[k], {{}, {0, -4.0 * static_cast<double>(k % 2), 25}}));
      }
    }
    must(world.step(0.001));
    for (const BodyId ball : balls) {
      highest = std::max(highest, world.pose(ball).position().z - world.pose(plate).position().z);
    }
  }
  EXPECT_GT(highest, -0.03);  // the balls reach it
  EXPECT_LT(highest, 0.0);
}

// The base is fixed, so the box on it does not couple to the tree. The arm's joint is solved all
// the same.
TEST(LinkContact, AMotorGoesOnWhileABoxLiesOnItsFixedBase) {
  World world;
  LinkSpec base = link_of(FixedJoint{}, kPlate, 1000.0);
  LinkSpec arm = link_of(RevoluteJoint{{0, 1, 0}}, Box{{0.3, 0.05, 0.05}}, 500.0);
  arm.parent = 0;
  arm.T_parent_joint = SE3(Vec3{1, 0, 1});
  const ArticulationId id = must(world.create_articulation({model_of({base, arm})}));
  must(world.add_collider(world.link_body(id, 0), collider_of(kPlate, kRough)));
  must(world.set_drive(id, 1, 0, {0.5, 0, 1e4, 1e3, 1e5}));
  add_dynamic(world,
              {.shape = Box{{0.1, 0.1, 0.1}}, .material = kRough, .pose = SE3(Vec3{0, 0, 0.16})});
  for (int i = 0; i < 1500; ++i) must(world.step(0.001));
  EXPECT_GT(world.counters().contacts, 0u);
  EXPECT_NEAR(world.joint_position(id, 1, 0), 0.5, 1e-3);
}

// Legs that push against one another through the ground: a spider with stiff motors stands with any
// number of solver iterations.
TEST(LinkContact, AWalkerThatIsDroppedStandsWithFewRounds) {
  for (const int iterations : {1, 2, 3, 6, 12}) {
    SCOPED_TRACE(iterations);
    World world({.velocity_iterations = iterations});
    add_ground(world, kRough);
    const Walker walker = add_walker(world, {0, 0, Walker::kHeight + 0.1}, kRough);
    double fastest = 0.0, last = 0.0;
    for (int i = 0; i < 3000; ++i) {
      must(world.step(0.001));
      last = 0.0;
      for (const double v : world.velocities(walker.id)) last = std::max(last, std::fabs(v));
      fastest = std::max(fastest, last);
    }
    EXPECT_LT(fastest, 40.0);  // a foot on 0.5 m, stopped after a fall of 0.1 m: 10 rad/s
    EXPECT_LT(last, 1e-3);
  }
}

// A trunk of two hundred kilograms on eight legs with feet, of 300 g each. The stops of the joints
// support it.
ArticulationId add_heavy_trunk(World& world) {
  const Box trunk{{0.2, 0.2, 0.1}}, foot{{0.06, 0.06, 0.02}};
  const Capsule shin{0.03, 0.1};
  const auto of_mass = [](const Shape& shape, double mass) {
    return mass / solid_inertia(shape, 1.0).mass();
  };
  JointForces stops;
  stops.lower = -0.3;
  stops.upper = 0.3;
  std::vector<LinkSpec> links{link_of(FreeJoint{}, trunk, of_mass(trunk, 200.0))};
  for (int leg = 0; leg < 8; ++leg) {
    const double angle = 2.0 * kPi * leg / 8;
    const Vec3 across{-std::sin(angle), std::cos(angle), 0};
    LinkSpec upper = link_of(RevoluteJoint{across}, shin, of_mass(shin, 0.2));
    upper.parent = 0;
    upper.T_parent_joint = SE3(Vec3{0.3 * std::cos(angle), 0.3 * std::sin(angle), 0});
    upper.damping = 0.1;
    upper.forces = {stops};
    LinkSpec lower = link_of(RevoluteJoint{across}, foot, of_mass(foot, 0.1));
    lower.parent = static_cast<int>(links.size());
    lower.T_parent_joint = SE3(Vec3{0, 0, -0.25});
    lower.damping = 0.1;
    lower.forces = {stops};
    links.push_back(upper);
    links.push_back(lower);
  }
  const ArticulationId id = must(world.create_articulation({model_of(links)}));
  must(world.add_collider(world.link_body(id, 0), collider_of(trunk, kRough)));
  for (int leg = 0; leg < 8; ++leg) {
    must(world.add_collider(world.link_body(id, 1 + 2 * leg), collider_of(shin, kRough)));
    must(world.add_collider(world.link_body(id, 2 + 2 * leg), collider_of(foot, kRough)));
  }
  std::vector<double> q(world.coordinates(id).begin(), world.coordinates(id).end());
  q[2] = 0.45;
  must(world.set_joint_states(id, q, std::vector<double>(world.velocities(id).size())));
  return id;
}

double fastest_joint(const World& world, ArticulationId id) {
  double most = 0.0;
  for (const double v : world.velocities(id)) most = std::max(most, std::fabs(v));
  return most;
}

// Few iterations do not converge within a step, but they do over several steps.
TEST(LinkContact, StopsCarryAHeavyTrunkWithFewRounds) {
  for (const int iterations : {1, 3, 12}) {
    for (const double rate : {1000.0, 240.0}) {
      SCOPED_TRACE(testing::Message() << iterations << " iterations, " << rate << " Hz");
      World world({.velocity_iterations = iterations});
      add_ground(world, kRough);
      const ArticulationId id = add_heavy_trunk(world);
      for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) must(world.step(1.0 / rate));
      EXPECT_LT(fastest_joint(world, id), 0.01);
    }
  }
}

// The impulse that supports the trunk for 17 ms is about thirty times that for half a millisecond.
TEST(LinkContact, StepsThatChangeInLengthDoNotJerkWhatStands) {
  World world;
  add_ground(world, kRough);
  const ArticulationId id = add_heavy_trunk(world);
  for (int i = 0; i < 2000; ++i) must(world.step(1e-3));
  double fastest = 0.0;
  for (int i = 0; i < 400; ++i) {
    must(world.step(i % 2 == 0 ? 5e-4 : 1.0 / 60));
    fastest = std::max(fastest, fastest_joint(world, id));
  }
  std::printf("at most %.2g rad/s\n", fastest);
  EXPECT_LT(fastest, 0.005);
}

// Nothing can stop the moving walls, so their contacts contradict one another, more in each step.
// The walker is squeezed, but not thrown out.
TEST(LinkContact, AWalkerBetweenWallsThatCloseIsNotThrownOut) {
  const Box wall{{0.1, 2.0, 1.0}};
  for (const double rate : kRates) {
    double fastest = 0.0;
    for (const double closing : {0.3, 0.7, 1.0, 1.6, 3.0}) {
      SCOPED_TRACE(testing::Message() << rate << " Hz, " << closing << " m/s");
      World world;
      add_ground(world, kRough);
      const Walker walker = add_walker(world, {0, 0, Walker::kHeight}, kRough);
      add_fixed(world, wall, kRough, SE3(Vec3{0.6, 0, 0.5}));
      add_kinematic(world, wall, se3{{}, {closing, 0, 0}}, kRough, SE3(Vec3{-0.7, 0, 0.5}));
      StepStatus status;
      for (int i = 0; i < static_cast<int>(1.5 / closing * rate); ++i) {
        status |= must(world.step(1.0 / rate));
        for (int link = 0; link < 9; ++link) {
          fastest = std::max(fastest, norm(world.velocity(world.link_body(walker.id, link)).v));
        }
      }
      EXPECT_FALSE(status.non_finite);
      EXPECT_TRUE(status.position_error);
    }
    std::printf("%g Hz: at most %.3g m/s\n", rate, fastest);
    EXPECT_LT(fastest, 300.0);  // of a foot; the joints' stiff motors contribute
  }
}

TEST(LinkContact, StepsToTheSameBitsFromASnapshot) {
  const auto build = [](World& world) {
    add_ground(world, kRough);
    const Plate lift = add_plate(world, PrismaticJoint{{0, 0, 1}}, kRough);
    must(world.set_drive(lift.id, 0, 0, {0.3, 0, 1e5, 1e4, 1e5}));
    add_stack(world, 4, 0.1, {});
    add_walker(world, {0.8, 0, 0.8}, kRough);
    add_stack(world, 2, 0.1, {0.8, 0, 0.9});
    add_ball(world, {0.1, 0.3, 0.3}, {1, 0, 0}, kRough);
  };
  World straight({.sleep_after = 0.2}), rolled({.sleep_after = 0.2});
  build(straight);
  build(rolled);
  std::vector<std::byte> bytes;
  for (int i = 0; i < 250; ++i) {
    bytes.clear();
    rolled.snapshot(bytes);
    must(rolled.step(0.004));
    must(rolled.restore(bytes));
    must(rolled.step(0.001));
    must(straight.step(0.001));
    ASSERT_EQ(straight.state_hash(), rolled.state_hash()) << i;
  }
}

}  // namespace
}  // namespace vp::test
