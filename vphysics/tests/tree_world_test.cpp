// Trees of links in a world: their motion, and impacts by and on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <vector>

#include "random.h"
#include "tree_scenes.h"
#include "vphysics/multibody/dynamics.h"
#include "vphysics/multibody/quantities.h"

namespace vp::test {
namespace {

// An articulation's state in a world, with the quantities of its model.
struct Look {
  Look(const World& world, ArticulationId id, const Model& of) : model(of), data(of) {
    forward_kinematics<double>(model, data, world.coordinates(id), world.velocities(id));
  }
  double energy() const {
    return kinetic_energy(model, data) + potential_energy(model, data, kGravity);
  }
  const Model& model;
  Data data;
};

std::vector<double> mass_of(const Model& model, std::span<const double> q) {
  Data data(model);
  const auto n = static_cast<std::size_t>(model.velocities());
  std::vector<double> M(n * n);
  mass_matrix<double>(model, data, q, M);
  return M;
}
// A dense solution by elimination, without code of the engine.
std::vector<double> solved(std::vector<double> M, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t r = i + 1; r < n; ++r) {
      const double f = M[r * n + i] / M[i * n + i];
      for (std::size_t c = i; c < n; ++c) M[r * n + c] -= f * M[i * n + c];
      b[r] -= f * b[i];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t c = i + 1; c < n; ++c) b[i] -= M[i * n + c] * b[c];
    b[i] /= M[i * n + i];
  }
  return b;
}
// The Jacobian row of a point fixed to a link along d, by central differences.
std::vector<double> row_by_differences(const Model& model, std::span<const double> q, int link,
                                       const Vec3& point, const Vec3& d) {
  Data data(model);
  forward_kinematics<double>(model, data, q, {});
  const Vec3 local = inverse_times(T_world_link(model, data, link), point);
  std::vector<double> row;
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < q.size(); ++i) {  // if the rates of q are velocities
    std::vector<double> moved(q.begin(), q.end());
    double along[2];
    for (const int side : {0, 1}) {
      moved[i] = q[i] + (side == 0 ? kStep : -kStep);
      forward_kinematics<double>(model, data, moved, {});
      along[side] = dot(d, T_world_link(model, data, link) * local);
    }
    row.push_back((along[0] - along[1]) / (2 * kStep));
  }
  return row;
}

// --- motion

TEST(Tree, ADoublePendulumKeepsItsEnergy) {
  const Model model = model_of(hanging_chain(2, RevoluteJoint{{0, 1, 0}}));
  double drift[2];
  for (const int half : {0, 1}) {
    World world;
    const ArticulationId id = must(world.create_articulation({model}));
    must(world.set_joint_states(id, std::vector<double>{2.0, 0.5}, std::vector<double>{0, 0}));
    const double start = Look(world, id, model).energy();
    const double dt = half == 0 ? kDt : 0.5 * kDt;
    double worst = 0.0;
    for (int i = 0; i < static_cast<int>(std::lround(5.0 / dt)); ++i) {
      must(world.step(dt));
      worst = std::max(worst, std::fabs(Look(world, id, model).energy() - start));
    }
    drift[half] = worst;
  }
  std::printf("worst energy error %.3g J at 1 ms, %.3g J at 0.5 ms, of 3 J that move\n", drift[0],
              drift[1]);
  EXPECT_LT(drift[0], 0.1);             // 0.067
  EXPECT_LT(drift[1], 0.7 * drift[0]);  // first order
}

// A double pendulum in each of its two normal modes, with the frequencies of the closed form for
// small amplitudes.
TEST(Tree, ADoublePendulumSwingsAtItsTwoFrequencies) {
  // Equal point masses m at lengths l: omega^2 = (2 -+ sqrt 2) g / l.
  const double l = 0.3, m = 0.8;
  std::vector<LinkSpec> links = hanging_chain(2, RevoluteJoint{{0, 1, 0}}, l);
  for (LinkSpec& link : links) link.inertia = Inertia(m, Vec3{}).InvXform(SE3(Vec3{0, 0, -l}));
  const Model model = model_of(links);
  for (const double sign : {-1.0, 1.0}) {
    World world;
    const ArticulationId id = must(world.create_articulation({model}));
    const double first = 0.01;  // the mode: absolute angles in the ratio 1 to -+ sqrt 2
    const double second = first * (-sign * std::sqrt(2.0)) - first;
    must(world.set_joint_states(id, std::vector<double>{first, second}, std::vector<double>{0, 0}));
    const double period = 2 * kPi / std::sqrt((2 + sign * std::sqrt(2.0)) * 9.81 / l);
    const int steps = static_cast<int>(std::lround(5 * period / kDt));
    for (int i = 0; i < steps; ++i) must(world.step(kDt));
    const double end = steps * kDt;
    const double phase = 2 * kPi * end / period;
    EXPECT_NEAR(world.joint_position(id, 0, 0), first * std::cos(phase), 0.02 * first);
    EXPECT_NEAR(world.joint_position(id, 1, 0), second * std::cos(phase), 0.02 * std::fabs(second));
  }
}

// Random trees of every kind of joint, floating without gravity and contacts.
TEST(Tree, AFloatingTreeKeepsItsMomentum) {
  Random random(61);
  double worst = 0.0;
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<LinkSpec> links(1);
    links[0].joint = FreeJoint{};
    links[0].inertia = solid_inertia(Box{{0.2, 0.1, 0.05}}, 800.0).Xform(SE3(random.in_cube(0.1)));
    const Joint joints[] = {RevoluteJoint{random.direction()}, PrismaticJoint{random.direction()},
                            BallJoint{}, UniversalJoint{}};
    for (const Joint& joint : joints) {
      LinkSpec link;
      link.parent = static_cast<int>(random.word() % links.size());
      link.joint = joint;
      link.T_parent_joint = random.pose(0.3);
      link.inertia = solid_inertia(Box{{0.1, 0.1, 0.05}}, 800.0);
      links.push_back(link);
    }
    const Model model = model_of(links);
    World world({.gravity = {}});
    const ArticulationId id = must(world.create_articulation({model}));
    std::vector<double> v;
    for (int i = 0; i < model.velocities(); ++i) v.push_back(random.uniform(-2, 2));
    must(world.set_joint_states(id, model.zero_coordinates(), v));
    const dse3 before = momentum(model, Look(world, id, model).data, Vec3{});
    for (int i = 0; i < 1000; ++i) must(world.step(kDt));
    const dse3 after = momentum(model, Look(world, id, model).data, Vec3{});
    worst = std::max({worst, norm(after.f - before.f) / norm(before.f),
                      norm(after.m - before.m) / norm(before.m)});
  }
  std::printf("momentum changed by %.3g of itself in a second\n", worst);
  EXPECT_LT(worst, 1e-11);
}

// --- impacts

// A ball hits a man's foot, across the rod's axis. With r the height of the axis above the ball,
// the rod acts as a mass I / r^2, and the impulse is that of two bodies.
TEST(Impact, OnARodsManIsThatOfTwoBodies) {
  const double e = 0.6, speed = 6.0, axial = 0.0015;
  const Material m{0.0, e, 0.0};
  World world({.gravity = {}});
  const double height = 0.09, foot = 0.0665;
  const Rod rod = add_rod(world, 0.0, height, 1, 0.0, m);
  const double start = 0.011 + kBallRadius + 0.02;
  const BodyId ball = add_ball(world, {start, 0, height - foot}, {-speed, 0, 0}, m);
  double impulse = 0.0;
  for (int i = 0; i < 8; ++i) {
    must(world.step(kDt));
    for (const ContactEvent& event : world.contact_events()) {
      if (event.kind == ContactEvent::Kind::hit) impulse += event.impulse;
    }
  }
  const double ball_mass = solid_inertia(Sphere{kBallRadius}, kBallDensity).mass();
  const double rod_mass = axial / (foot * foot);
  const double expected = (1 + e) * speed / (1 / ball_mass + 1 / rod_mass);
  EXPECT_NEAR(impulse, expected, 1e-6 * expected);
  EXPECT_NEAR(std::fabs(world.joint_velocity(rod.articulation, 0, 1)), expected * foot / axial,
              1e-6 * expected * foot / axial);
  const SE3 T = world.pose(ball);
  EXPECT_NEAR(T.rotate(world.velocity(ball).v).x, expected / ball_mass - speed, 1e-6 * speed);
}

// All velocities of a chain after a ball has hit one of its links, against a dense solution with
// the mass matrix and a Jacobian by differences.
TEST(Impact, OnAChainChangesAllItsVelocitiesAsTheMassMatrixSays) {
  const double e = 0.5, speed = 5.0;
  const Material m{0.0, e, 0.0};
  for (const int struck : {0, 2, 4}) {
    World world({.gravity = {}});
    const Model model = model_of(hanging_chain(5, UniversalJoint{}));
    const ArticulationId chain = must(world.create_articulation({model}));
    std::vector<double> q, rest(static_cast<std::size_t>(model.velocities()));
    Random random(62);
    for (int i = 0; i < model.coordinates(); ++i) q.push_back(random.uniform(-0.3, 0.3));
    must(world.set_joint_states(chain, q, rest));
    const BodyId link = world.link_body(chain, struck);
    must(world.add_collider(link, collider_of(Sphere{0.03}, m, SE3(Vec3{0, 0, -0.12}))));
    const Vec3 centre = world.pose(link) * Vec3{0, 0, -0.12};
    const Vec3 n = (1 / norm(Vec3{1, 0.3, 0.2})) * Vec3{1, 0.3, 0.2};
    Part part{.shape = Sphere{0.04}, .material = m, .density = 2000.0};
    part.pose = SE3(centre - 0.0712 * n);
    part.velocity = {{}, speed * n};
    part.continuous = true;
    const BodyId ball = add_dynamic(world, part);
    must(world.step(kDt));
    ASSERT_EQ(world.counters().impacts, 1u);

    const std::vector<double> J = row_by_differences(model, q, struck, centre - 0.03 * n, n);
    const std::vector<double> response = solved(mass_of(model, q), J);
    const double k = std::inner_product(J.begin(), J.end(), response.begin(), 0.0);
    const double ball_mass = solid_inertia(part.shape, part.density).mass();
    const double p = (1 + e) * speed / (1 / ball_mass + k);
    const double fastest =
        p * std::fabs(*std::max_element(response.begin(), response.end(), [](double a, double b) {
          return std::fabs(a) < std::fabs(b);
        }));
    for (std::size_t i = 0; i < J.size(); ++i) {
      EXPECT_NEAR(world.velocities(chain)[i], p * response[i], 1e-6 * fastest) << i;
    }
    const Vec3 after = world.pose(ball).rotate(world.velocity(ball).v);
    EXPECT_NEAR(dot(n, after), speed - p / ball_mass, 1e-6 * speed);
  }
}

// A ball hits a floating tree, with friction: total momentum is conserved, about any point.
TEST(Impact, OnAFloatingTreeKeepsTheMomentumOfAll) {
  const Material m{0.5, 0.4, 0.0};
  World world({.gravity = {}});
  const Walker walker = add_walker(world, {0, 0, 0}, m);
  const BodyId foot_side = add_dynamic(world, {.shape = Sphere{0.05},
                                               .material = m,
                                               .density = 3000.0,
                                               .pose = SE3(Vec3{0.8, 0.12, -0.49}),
                                               .velocity = {{3, 1, 2}, {-6, 0.3, 0.2}},
                                               .continuous = true});
  const Model* model = world.model(walker.id);
  const Inertia J = solid_inertia(Sphere{0.05}, 3000.0);
  const auto total = [&] {
    const dse3 tree = momentum(*model, Look(world, walker.id, *model).data, Vec3{});
    const SE3 T = world.pose(foot_side);
    const Vec3 p = J.mass() * T.rotate(world.velocity(foot_side).v);
    const Vec3 spin = J.rotational().xx * T.rotate(world.velocity(foot_side).w);
    return dse3{tree.m + spin + cross(T.position(), p), tree.f + p};
  };
  const dse3 before = total();
  bool hit = false;
  for (int i = 0; i < 200; ++i) {
    must(world.step(kDt));
    hit = hit || !world.contact_events().empty();
    // Position correction may change a momentum's arm; the effect is below these bounds.
    ASSERT_LT(norm(total().f - before.f), 1e-10 * norm(before.f)) << i;
    ASSERT_LT(norm(total().m - before.m), 1e-6 * norm(before.m)) << i;
  }
  EXPECT_TRUE(hit);
}

// Two carts on one line.
TEST(Impact, OfTwoArticulationsIsElastic) {
  const Material m{0.0, 1.0, 0.0};
  World world({.gravity = {}});
  ArticulationId carts[2];
  const double mass[2] = {2.0, 0.7};
  for (const int i : {0, 1}) {
    LinkSpec link;
    link.joint = PrismaticJoint{{1, 0, 0}};
    link.inertia = Inertia(mass[i], Vec3{1, 1, 1});
    carts[i] = must(world.create_articulation({model_of({link})}));
    must(world.add_collider(world.link_body(carts[i], 0), collider_of(Box{{0.1, 0.1, 0.1}}, m)));
    must(world.set_joint_state(carts[i], 0, 0, i == 0 ? -0.5 : 0.5, i == 0 ? 3.0 : -1.0));
  }
  for (int i = 0; i < 500; ++i) must(world.step(kDt));
  // v1' = (m1 - m2) / (m1 + m2) v1 + 2 m2 / (m1 + m2) v2, and the same for v2'.
  const double sum = mass[0] + mass[1];
  EXPECT_NEAR(world.joint_velocity(carts[0], 0, 0),
              ((mass[0] - mass[1]) * 3.0 + 2 * mass[1] * -1.0) / sum, 1e-9);
  EXPECT_NEAR(world.joint_velocity(carts[1], 0, 0),
              ((mass[1] - mass[0]) * -1.0 + 2 * mass[0] * 3.0) / sum, 1e-9);
}

TEST(Tree, ItsOwnLinksDoNotMeet) {
  World world({.gravity = {}});
  const ArticulationId id =
      must(world.create_articulation({model_of(hanging_chain(3, RevoluteJoint{{0, 1, 0}}))}));
  for (int l = 0; l < 3; ++l) {
    must(world.add_collider(world.link_body(id, l), collider_of(Sphere{0.3}, kSmooth)));
  }
  for (int i = 0; i < 20; ++i) {
    must(world.step(kDt));
    ASSERT_EQ(world.counters().contacts, 0u);
    ASSERT_TRUE(world.contact_events().empty());
  }
  EXPECT_EQ(world.joint_velocity(id, 1, 0), 0.0);
}

// --- resting

// A single floating link is a rigid body: dropped with a tilt and sliding, a link and a body come
// to rest at the same pose.
TEST(Contact, OfALinkThatFloatsAloneIsThatOfABody) {
  const Material m{0.4, 0.3, 0.0};
  const Shape box = Box{{0.1, 0.1, 0.1}};
  World bodies({.sub_steps = 1}), links({.sub_steps = 1});
  add_ground(bodies, m);
  add_ground(links, m);
  const SE3 pose(Exp(Vec3{0.3, 0.2, 0.1}), {0, 0, 0.25});
  const se3 velocity{{1, 2, 3}, {0.5, -0.2, 0.3}};
  const BodyId body = add_dynamic(
      bodies, {.shape = box, .material = m, .density = 700.0, .pose = pose, .velocity = velocity});
  LinkSpec link;
  link.joint = FreeJoint{};
  link.inertia = solid_inertia(box, 700.0);
  const ArticulationId id = must(links.create_articulation({model_of({link})}));
  const BodyId other = links.link_body(id, 0);
  must(links.add_collider(other, collider_of(box, m)));
  const Quaternion r = to_quaternion(pose.rotation());
  must(links.set_joint_states(id, std::vector<double>{0, 0, 0.25, r.x, r.y, r.z, r.w},
                              std::vector<double>{1, 2, 3, 0.5, -0.2, 0.3}));
  double flight = 0.0, all = 0.0;
  for (int i = 0; i < 1000; ++i) {
    must(bodies.step(kDt));
    must(links.step(kDt));
    const Vec3 corner{0.1, 0.1, 0.1};
    const double apart = norm(bodies.pose(body) * corner - links.pose(other) * corner);
    all = std::max(all, apart);
    if (bodies.contact_events().empty() && flight == all) continue;
    if (i < 100) flight = std::max(flight, apart);
  }
  std::printf("corners apart by %.3g m at most in the first 0.1 s, %.3g m in all\n", flight, all);
  EXPECT_LT(flight, 1e-9);
  EXPECT_LT(all, 0.05);  // sub-steps for bodies, impacts for links: 0.033
}

// It stands on four driven legs with two joints each; every foot carries a quarter of the weight.
TEST(Contact, AWalkerStandsOnItsFourFeet) {
  for (const double dt : {0.001, 1.0 / 240, 1.0 / 60}) {
    World world;
    const Material m{0.8, 0.0, 0.0};
    add_ground(world, m);
    const Walker walker = add_walker(world, {0, 0, Walker::kHeight + 0.001}, m);
    const BodyId trunk = world.link_body(walker.id, 0);
    for (int i = 0; i < static_cast<int>(2.0 / dt); ++i) must(world.step(dt));
    const Vec3 converged = world.pose(trunk).position();
    for (int i = 0; i < static_cast<int>(2.0 / dt); ++i) must(world.step(dt));
    const SE3 T = world.pose(trunk);
    std::printf("at %.2f ms: trunk sunk by %.3g mm, in two seconds moved by %.3g mm\n", 1e3 * dt,
                1e3 * (Walker::kHeight - T.position().z), 1e3 * norm(T.position() - converged));
    EXPECT_NEAR(T.position().z, Walker::kHeight, 0.002) << dt;
    EXPECT_GT(T.rotation().cz.z, 0.9999) << dt;
    EXPECT_LT(norm(T.position() - converged), 1e-3) << dt;
    EXPECT_LT(norm(world.velocity(trunk).v), 0.01) << dt;
  }
}

// A chain falls on a floor, and a pendulum swings against a wall, with steps of any length.
TEST(Contact, OfAChainWithTheFloorHoldsAtLongSteps) {
  for (const double dt : {0.001, 1.0 / 240, 1.0 / 60}) {
    World world;
    const Material m{0.5, 0.0, 0.0};
    add_fixed(world, HalfSpace{}, m, SE3(Vec3{0, 0, -0.45}));
    const ArticulationId id =
        must(world.create_articulation({model_of(hanging_chain(4, UniversalJoint{}))}));
    for (int l = 0; l < 4; ++l) {
      must(world.add_collider(world.link_body(id, l),
                              collider_of(Capsule{0.02, 0.08}, m, SE3(Vec3{0, 0, -0.1}))));
    }
    // It starts level, stretched along x.
    std::vector<double> q(8), v(8);
    q[1] = -kPi / 2;
    q[2] = 0.2;
    must(world.set_joint_states(id, q, v));
    double deepest = 0.0, fastest = 0.0;
    for (int i = 0; i < static_cast<int>(4.0 / dt); ++i) {
      const StepStatus status = must(world.step(dt));
      ASSERT_FALSE(status.non_finite);
      for (int l = 0; l < 4; ++l) {
        const SE3 T = world.pose(world.link_body(id, l));
        for (const double end : {-0.02, -0.18}) {
          deepest = std::max(deepest, -0.45 + 0.02 - (T * Vec3{0, 0, end}).z);
        }
      }
      for (const double x : world.velocities(id)) fastest = std::max(fastest, std::fabs(x));
    }
    std::printf("at %.1f ms: %.3g mm deep, %.3g rad/s at most\n", 1e3 * dt, 1e3 * deepest, fastest);
    EXPECT_LT(deepest, 0.01) << dt;
    EXPECT_LT(fastest, 100.0) << dt;
  }
}

// --- motors, damping

TEST(Tree, MotorsOfAnyStiffnessHoldAnArm) {
  for (const double stiffness : {1e3, 1e6, 1e12}) {
    World world;
    const ArticulationId id =
        must(world.create_articulation({model_of(hanging_chain(6, RevoluteJoint{{0, 1, 0}}))}));
    for (int l = 0; l < 6; ++l) {
      must(world.set_drive(id, l, 0, {0.3, 0.0, stiffness, 0.1 * stiffness, 1e9}));
    }
    double farthest = 0.0;
    for (int i = 0; i < 2000; ++i) {
      must(world.step(kDt));
      for (const double x : world.coordinates(id)) farthest = std::max(farthest, std::fabs(x));
    }
    EXPECT_LT(farthest, 0.5) << stiffness;
    for (int l = 0; l < 6; ++l) {
      EXPECT_NEAR(world.joint_position(id, l, 0), 0.3, 0.02) << stiffness;
      EXPECT_LT(std::fabs(world.joint_velocity(id, l, 0)), 1e-2) << stiffness;
    }
  }
}

TEST(Tree, DampingOfAnySizeIsStable) {
  for (const double damping : {0.1, 1e3, 1e9}) {
    std::vector<LinkSpec> links = hanging_chain(5, RevoluteJoint{{0, 1, 0}});
    for (LinkSpec& link : links) link.damping = damping;
    const Model model = model_of(links);
    World world;
    const ArticulationId id = must(world.create_articulation({model}));
    must(world.set_joint_states(id, std::vector<double>{1, 0, 0, 0, 0},
                                std::vector<double>{0, 5, 0, -5, 0}));
    double before = Look(world, id, model).energy();
    for (int i = 0; i < 1000; ++i) {
      must(world.step(kDt));
      const double now = Look(world, id, model).energy();
      ASSERT_LT(now, before + 1e-3) << damping;
      before = now;
    }
  }
}

TEST(Limit, OfATreeHoldsAgainstItsWeight) {
  World world;
  std::vector<LinkSpec> links = hanging_chain(3, RevoluteJoint{{0, 1, 0}});
  for (LinkSpec& link : links) link.forces = {stops(-0.2, 0.2)};
  const ArticulationId id = must(world.create_articulation({model_of(links)}));
  must(world.set_joint_states(id, std::vector<double>{0.2, 0.2, 0.2},
                              std::vector<double>{5, -5, 5}));
  double beyond = 0.0;
  for (int i = 0; i < 3000; ++i) {
    must(world.step(kDt));
    for (const double x : world.coordinates(id)) beyond = std::max(beyond, std::fabs(x) - 0.2);
  }
  std::printf("beyond its limits by %.3g rad at most\n", beyond);
  EXPECT_LT(beyond, 1e-4);
}

// --- state

struct Mixed {
  World world;
  Walker walker;
  ArticulationId chain;
};
Mixed mixed_scene() {
  Mixed s;
  const Material m{0.6, 0.2, 1e-4};
  add_ground(s.world, m);
  s.walker = add_walker(s.world, {0, 0, Walker::kHeight + 0.1}, m);
  std::vector<LinkSpec> links = hanging_chain(4, BallJoint{});
  links[0].T_parent_joint = SE3(Vec3{0.6, 0, 0.9});
  links[1].damping = 0.01;
  s.chain = must(s.world.create_articulation({model_of(links)}));
  for (int l = 0; l < 4; ++l) {
    must(s.world.add_collider(s.world.link_body(s.chain, l),
                              collider_of(Capsule{0.02, 0.08}, m, SE3(Vec3{0, 0, -0.1}))));
  }
  add_dynamic(s.world, {.shape = Sphere{0.06},
                        .material = m,
                        .density = 2000.0,
                        .pose = SE3(Vec3{1.2, 0.02, 0.4}),
                        .velocity = {{}, {-5, 0, 2}},
                        .continuous = true});
  return s;
}

// The same with every compiler and optimisation level.
TEST(Determinism, GoldenHashOfTrees) {
  Mixed s = mixed_scene();
  for (int i = 0; i < 1000; ++i) must(s.world.step(kDt));
  EXPECT_EQ(s.world.state_hash(), 16414793750983454116u);
}

TEST(Snapshot, OfTreesStepsToTheSameBits) {
  Mixed straight = mixed_scene(), rolled = mixed_scene();
  std::vector<std::byte> bytes;
  for (int i = 0; i < 600; ++i) {
    bytes.clear();
    rolled.world.snapshot(bytes);
    must(rolled.world.step(0.004));
    must(rolled.world.restore(bytes));
    must(rolled.world.step(kDt));
    must(straight.world.step(kDt));
    ASSERT_EQ(straight.world.state_hash(), rolled.world.state_hash()) << i;
  }
  Mixed fresh = mixed_scene();
  must(fresh.world.restore(bytes));
  must(fresh.world.step(kDt));
  EXPECT_EQ(straight.world.state_hash(), fresh.world.state_hash());
}

}  // namespace
}  // namespace vp::test
