// Bodies without contacts conserve angular momentum and energy, at every step and with every shape.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "random.h"
#include "rig.h"
#include "world/free_rotation.h"

namespace vp::test {
namespace {

const Box kRod{{0.02, 0.02, 0.5}};

struct Spin {
  Vec3 momentum;  // world frame
  double energy;
};
Spin spin_of(const World& world, BodyId body) {
  const Inertia J = world.inertia(body);
  const Vec3 w = world.velocity(body).w, L = J.central() * w;
  return {world.pose(body).rotate(L), 0.5 * dot(w, L)};
}

struct Worst {
  double momentum = 0.0, energy = 0.0;  // relative to the initial values
};
Worst worst_of(World& world, BodyId body, double dt, double time) {
  const Spin start = spin_of(world, body);
  Worst worst;
  for (int i = 0; i * dt < time; ++i) {
    must(world.step(dt));
    const Spin now = spin_of(world, body);
    worst.momentum =
        std::max(worst.momentum, norm(now.momentum - start.momentum) / norm(start.momentum));
    worst.energy = std::max(worst.energy, std::fabs(now.energy / start.energy - 1.0));
  }
  return worst;
}

struct SpinCase {
  Vec3 w;
  double dt;
};
const SpinCase kSlender[] = {{{150, 1, 20}, 0.001},    {{50, 1, 20}, 0.001},
                             {{20, 1, 20}, 1.0 / 240}, {{20, 0, 5}, 1.0 / 60},
                             {{10, 0, 1}, 1.0 / 60},   {{150, 1, 20}, 1.0 / 30}};

// Another body far away. With a continuous body, a step runs the impact stage.
enum class Other { none, ordinary, continuous, bouncing };
void add_other(World& world, Other other) {
  if (other == Other::none) return;
  Part ball{.shape = Sphere{0.1}, .material = {0.0, 1.0}, .pose = SE3(Vec3{50, 0, 0})};
  ball.continuous = other != Other::ordinary;
  if (other == Other::bouncing) {
    ball.velocity = {{}, {7.3, 0, 0}};
    for (const double x : {49.8, 50.3}) {
      add_fixed(world, Box{{0.05, 1, 1}}, {0.0, 1.0}, SE3(Vec3{x, 0, 0}));
    }
  }
  add_dynamic(world, ball);
}

TEST(FreeBody, OfSlenderShapeKeepsMomentumAndEnergy) {
  double most_momentum = 0.0, most_energy = 0.0;
  for (const SpinCase& c : kSlender) {
    for (const bool continuous : {false, true}) {
      for (const Other other : {Other::none, Other::ordinary, Other::continuous, Other::bouncing}) {
        World world({.gravity = {}});
        const BodyId rod =
            add_dynamic(world, {.shape = kRod, .velocity = {c.w, {}}, .continuous = continuous});
        add_other(world, other);
        const Worst worst = worst_of(world, rod, c.dt, 20.0);
        EXPECT_LT(worst.momentum, 1e-9) << c.w.x << " at " << c.dt << ", " << continuous;
        EXPECT_LT(worst.energy, 1e-7) << c.w.x << " at " << c.dt << ", " << continuous;
        most_momentum = std::max(most_momentum, worst.momentum);
        most_energy = std::max(most_energy, worst.energy);
      }
    }
  }
  std::printf("momentum %.1e, energy %.1e\n", most_momentum, most_energy);
}

// Needles, plates, boxes, cones; slow and fast.
TEST(FreeBody, OfEveryShapeKeepsMomentumAndEnergyAtEveryStep) {
  const Shape shapes[] = {
      Box{{0.1, 0.2, 0.3}}, Box{{0.002, 0.3, 0.5}}, Box{{0.001, 0.002, 0.5}},  Capsule{0.01, 0.5},
      Cylinder{0.5, 0.005}, Cone{0.2, 0.4},         Box{{0.1, 0.1, 0.1000001}}};
  Random random(31);
  double most_momentum = 0.0, most_energy = 0.0;
  for (const Shape& shape : shapes) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 0.001, 0.0001}) {
      for (const double rate : {0.001, 0.3, 7.0, 150.0, 4000.0}) {
        World world({.gravity = {}});
        const BodyId body = add_dynamic(world, {.shape = shape,
                                                .pose = SE3(random.rotation(), {}),
                                                .velocity = {rate * random.direction(), {}}});
        const Worst worst = worst_of(world, body, dt, 1000 * dt);
        EXPECT_LT(worst.momentum, 1e-11) << rate << " at " << dt;
        EXPECT_LT(worst.energy, 1e-8) << rate << " at " << dt;
        most_momentum = std::max(most_momentum, worst.momentum);
        most_energy = std::max(most_energy, worst.energy);
      }
    }
  }
  std::printf("momentum %.1e, energy %.1e\n", most_momentum, most_energy);
}

// The body has a contact slot, since its speed might take it to the other body, but it has no
// contact.
// A rope that is not taut changes nothing about a continuous body.
TEST(FreeBody, OnASlackRopeKeepsMomentumAndEnergy) {
  for (const double dt : {1.0 / 60.0, 0.001}) {
    World world({.gravity = {}});
    const BodyId body = add_dynamic(
        world,
        {.shape = Box{{0.5, 0.3, 0.1}}, .velocity = {{0.2, 4.0, 0.3}, {}}, .continuous = true});
    JointDesc rope;
    rope.kind = Distance{0.0, 100.0};
    must(world.create_joint(add_fixed(world, Sphere{0.1}, {}, SE3(Vec3{5, 0, 0})), body, rope));
    const Worst worst = worst_of(world, body, dt, 10.0);
    EXPECT_LT(worst.momentum, 1e-9) << dt;
    EXPECT_LT(worst.energy, 1e-7) << dt;
  }
}

// A continuous rod on a hinge whose axis is no principal axis: only a free one would tumble.
TEST(FreeBody, OnAHingeAboutAnyAxisKeepsItsSpinAndItsAxis) {
  constexpr double kTilt = 0.5, kSpin = 20.0;
  for (const double dt : {1.0 / 60.0, 0.001}) {
    World world({.gravity = {}});
    const SE3 tilted{Exp(Vec3{kTilt, 0, 0}), Vec3{}};
    const BodyId rod =
        add_dynamic(world, {.shape = Box{{0.05, 0.05, 0.5}}, .pose = tilted, .continuous = true});
    JointDesc hinge;
    hinge.kind = Hinge{};
    hinge.T_a_joint = SE3(Vec3{-5, 0, 0});
    hinge.T_b_joint = Inv(tilted);
    must(world.create_joint(add_fixed(world, Sphere{0.1}, {}, SE3(Vec3{5, 0, 0})), rod, hinge));
    must(world.set_velocity_world(rod, {{}, {0, 0, kSpin}}));
    for (int i = 0; i < std::lround(5.0 / dt); ++i) must(world.step(dt));
    const Vec3 axis = world.pose(rod).rotation() * (Inv(tilted).rotation() * Vec3{0, 0, 1});
    EXPECT_LT(norm(axis - Vec3{0, 0, 1}), 1e-9) << dt;
    EXPECT_NEAR(world.velocity_world(rod).angular.z, kSpin, 1e-6) << dt;
  }
}

// A continuous disc that spins on a ball joint at the end of its axis: a torque about the vertical
// axis does not exist, so that angular momentum about it stays, with an error of first order.
TEST(FreeBody, ThatIsATopOnABallJointKeepsItsVerticalMomentum) {
  double before = 1.0;
  for (const double dt : {0.002, 0.001, 0.0005}) {
    World world;
    const BodyId pivot = add_fixed(world, Sphere{0.05}, {});
    const BodyId disc = add_dynamic(world, {.shape = Cylinder{0.5, 0.05},
                                            .pose = SE3(Exp(Vec3{0, 0.5 * kPi, 0}), Vec3{1, 0, 0}),
                                            .continuous = true});
    const Inertia J = world.inertia(disc);
    const double mass = J.mass(), about_axis = 0.5 * mass * 0.25, spin = 60.0;
    const double precession = mass * kG / (about_axis * spin);
    const Vec3 w{spin, 0, precession};
    must(world.set_velocity_world(disc, {cross(w, Vec3{1, 0, 0}), w}));
    JointDesc ball;
    ball.kind = BallSocket{};
    ball.T_b_joint = SE3(Vec3{0, 0, -1});
    must(world.create_joint(pivot, disc, ball));
    const auto vertical = [&] {
      const SE3 T = world.pose(disc);
      const VelocityWorld V = world.velocity_world(disc);
      const Vec3 spun = T.rotation() * (J.central() * transposed_times(T.rotation(), V.angular));
      return (spun + mass * cross(T.position(), V.linear)).z;
    };
    const double start = vertical();
    for (int i = 0; i < std::lround(1.0 / dt); ++i) must(world.step(dt));
    const double error = std::fabs(vertical() - start) / start;
    EXPECT_LT(error, 0.6 * before) << dt;
    before = error;
  }
  EXPECT_LT(before, 0.1);
}

TEST(FreeBody, NearAnotherKeepsMomentumAndEnergy) {
  World world;
  // Near a plate that a strong force pulls it has contact points that it does not touch.
  BodyDesc desc, fixed;
  fixed.motion = Motion::fixed;
  desc.gravity_scale = 10.0;
  desc.T_world_body = SE3(Vec3{0, 0, -0.28});
  const BodyId plate = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = Box{{1, 1, 0.1}};
  must(world.add_collider(plate, collider));
  const BodyId ground = must(world.create_body(fixed));
  JointDesc weld;
  weld.kind = Weld{};
  weld.T_a_joint = desc.T_world_body;
  must(world.create_joint(ground, plate, weld));
  desc.gravity_scale = 0.0;
  desc.T_world_body = {};
  const BodyId box = must(world.create_body(desc));
  collider.shape = Box{{0.1, 0.12, 0.06}};
  must(world.add_collider(box, collider));
  must(world.set_velocity(box, {{9, 5, 0}, {}}));
  const Spin start = spin_of(world, box);
  std::uint32_t held = 0;
  for (int i = 0; i < 1200; ++i) {
    must(world.step(1.0 / 60));
    held += world.counters().manifolds;
    const Spin now = spin_of(world, box);
    ASSERT_LT(norm(now.momentum - start.momentum), 1e-9 * norm(start.momentum)) << i;
    ASSERT_NEAR(now.energy, start.energy, 1e-7 * start.energy) << i;
  }
  EXPECT_GT(held, 100u);
}

// Closed form: a symmetric body rotates about L at |L| / I1 and about its axis at w3 (1 - I3 / I1).
TEST(FreeBody, OfSymmetricShapeFollowsTheClosedForm) {
  const Inertia J = solid_inertia(kRod, 1000);
  const Sym3 I = J.central();
  const Vec3 w0{3, 1, 9};
  const Vec3 L = I * w0;
  const double time = 2.0;
  const Mat3 exact =
      (Exp((time / I.xx) * L) * Exp(Vec3{0, 0, time * w0.z * (1.0 - I.zz / I.xx)})).matrix();
  double last = 0.0;
  for (const double dt : {1.0 / 120, 1.0 / 240, 1.0 / 480}) {
    World world({.gravity = {}});
    const BodyId rod = add_dynamic(world, {.shape = kRod, .velocity = {w0, {}}});
    for (int i = 0; i * dt < time - 1e-9; ++i) must(world.step(dt));
    const Mat3 R = world.pose(rod).rotation();
    const double error = norm(R.cx - exact.cx) + norm(R.cz - exact.cz);
    std::printf("off by %.1e at %.4f s\n", error, dt);
    EXPECT_LT(error, 0.02);
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 4.0, 0.3);  // second order
    }
    last = error;
  }
}

// About a principal axis the angle is rate times time, at every step.
TEST(FreeBody, AboutAPrincipalAxisTurnsByTheAngle) {
  for (const double dt : {1.0 / 30, 0.001}) {
    World world({.gravity = {}});
    const BodyId rod = add_dynamic(world, {.shape = kRod, .velocity = {{0, 0, 90}, {}}});
    const int steps = static_cast<int>(std::lround(3.0 / dt));
    for (int i = 0; i < steps; ++i) must(world.step(dt));
    const Vec3 x = world.pose(rod).rotation().cx;
    EXPECT_LT(norm(x - Vec3{std::cos(270.0), std::sin(270.0), 0}), 1e-9) << dt;
  }
}

TEST(FreeBody, ComesToTheSameEndAtAConstantRate) {
  Random random(32);
  const Sym3 I = solid_inertia(kRod, 1000).central();
  for (int i = 0; i < 2000; ++i) {
    const Vec3 w = std::exp(random.uniform(-8, 5)) * random.direction();
    const FreeRotation turn = free_rotation(I, inverse(I), w, 1.0 / 30);
    const Mat3 a = from_quaternion(turn.q), b = Exp(mean_rotation(turn)).matrix();
    ASSERT_LT(norm(a.cx - b.cx) + norm(a.cy - b.cy), 1e-9) << i;
  }
  // Angles beyond a full revolution are returned in full.
  for (const double rate : {1.0, 100.0, 200.0, -200.0, 500.0, -1000.0}) {
    const FreeRotation turn = free_rotation(I, inverse(I), {0, 0, rate}, 1.0 / 30);
    EXPECT_NEAR(mean_rotation(turn).z, rate / 30, 1e-9);
  }
}

// Bodies that tumble on the ground without friction or restitution never gain energy.
TEST(FreeBody, SlenderOnesThatTouchTheGroundGainNoEnergy) {
  const Vec3 gravity{0, 0, -9.81};
  double most = 0.0;
  for (const bool continuous : {false, true}) {
    for (const double dt : {1.0 / 60, 1.0 / 240, 0.001}) {
      for (const Vec3& w : {Vec3{150, 1, 20}, Vec3{20, 1, 20}, Vec3{5, 3, 60}}) {
        World world({.gravity = gravity});
        add_ground(world, {0.2, 0.0});
        const BodyId rod =
            add_dynamic(world, {.shape = kRod,
                                .material = {0.2, 0.0},
                                .pose = SE3(Exp(Vec3{0.9, 0.4, 0}).matrix(), {0, 0, 0.6}),
                                .velocity = {w, {}},
                                .continuous = continuous});
        const Inertia J = world.inertia(rod);
        const auto energy = [&] {
          const se3 V = world.velocity(rod);
          return 0.5 * (V * (J * V)) - J.mass() * dot(gravity, world.pose(rod).position());
        };
        const double start = energy();
        double worst = 0.0;
        for (int i = 0; i * dt < 5.0; ++i) {
          must(world.step(dt));
          worst = std::max(worst, energy() / start);
        }
        most = std::max(most, worst);
      }
    }
  }
  EXPECT_LT(most, 1.001);
}

}  // namespace
}  // namespace vp::test
