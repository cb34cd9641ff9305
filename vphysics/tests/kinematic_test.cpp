// Kinematic bodies that accelerate, and what they carry, grip and hit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "joints_rig.h"

namespace vp::test {
namespace {

// Moves it so that its displacement is that of a given function of time.
template <class F>
void follow(World& world, BodyId body, const Vec3& along, const F& displacement, double seconds,
            double dt) {
  for (int i = 0; i < std::lround(seconds / dt); ++i) {
    const double speed = (displacement((i + 1) * dt) - displacement(i * dt)) / dt;
    must(world.set_velocity_world(body, {speed * along, {}}));
    must(world.step(dt));
  }
}
double sine_of_2_hz(double t) {
  return 0.05 * (1.0 - std::cos(4.0 * kPi * t));
}

// A lift with a slope of 0.3 rad that needs 0.62 of the friction, at up to 0.8 of the gravity.
TEST(Kinematic, ALiftCarriesWhatFrictionHolds) {
  for (const double dt : {1.0 / 60.0, 1.0 / 240.0, 0.001}) {
    World world;
    const Material material{.friction = 0.5};
    const SE3 slope(Exp(Vec3{0, 0.3, 0}), {});
    const BodyId lift = add_kinematic(world, Box{{1, 1, 0.1}}, {}, material, slope);
    const BodyId box = add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}},
                                           .material = material,
                                           .pose = slope * SE3(Vec3{0, 0, 0.2})});
    run(world, 0.5, dt);
    const SE3 start = Inv(world.pose(lift)) * world.pose(box);
    follow(world, lift, {0, 0, 1}, sine_of_2_hz, 5.0, dt);
    const SE3 end = Inv(world.pose(lift)) * world.pose(box);
    std::printf("%4.0f Hz: slid by %.2g mm\n", 1.0 / dt,
                1e3 * norm(end.position() - start.position()));
    EXPECT_LT(norm(end.position() - start.position()), 5e-4);
  }
}

// Two fingers on a hand that shakes squeeze a box with three times the force that it needs at rest.
TEST(Kinematic, AGripperHoldsWhatItShakes) {
  for (const double dt : {1.0 / 60.0, 1.0 / 240.0, 0.001}) {
    WorldDesc desc;
    desc.length_unit = 0.1;
    World world(desc);
    const Material material{.friction = 0.5};
    const BodyId hand =
        add_kinematic(world, Box{{0.3, 0.05, 0.02}}, {}, material, SE3(Vec3{0, 0, 1}));
    const BodyId box = add_dynamic(
        world,
        {.shape = Box{{0.04, 0.04, 0.04}}, .material = material, .pose = SE3(Vec3{0, 0, 0.9})});
    const double weight = world.inertia(box).mass() * kG;
    for (const double side : {-1.0, 1.0}) {
      const SE3 at(Vec3{0.0501 * side, 0, 0.9});
      const BodyId finger =
          add_dynamic(world, {.shape = Box{{0.01, 0.02, 0.05}}, .material = material, .pose = at});
      // z towards the box
      const SE3 axis(Exp(Vec3{0, -0.5 * kPi * side, 0}), at.position());
      join(world, hand, finger, Slider{-kNoLimit, kNoLimit, {0.0, 10.0, 0.0, 1e9, 3.0 * weight}},
           axis);
    }
    run(world, 0.5, dt);
    follow(world, hand, {0, 0, 1}, sine_of_2_hz, 0.5, dt);
    const double start = world.pose(box).position().z - world.pose(hand).position().z;
    follow(world, hand, {0, 0, 1}, sine_of_2_hz, 5.0, dt);
    const double end = world.pose(box).position().z - world.pose(hand).position().z;
    std::printf("%4.0f Hz: slipped by %.2g mm\n", 1.0 / dt, 1e3 * (start - end));
    EXPECT_LT(std::fabs(start - end), 1.5e-3);
  }
}

// What accelerates evenly ends where its twists lead, whatever the sub-steps do.
TEST(Kinematic, EndsWhereItIsToldTo) {
  World world;
  const BodyId body = add_kinematic(world, Sphere{0.1}, {}, {}, SE3(Vec3{0, 0, 5}));
  follow(
      world, body, {1, 0, 0}, [](double t) { return 3.0 * t * t; }, 1.0, 1.0 / 60.0);
  EXPECT_NEAR(world.pose(body).position().x, 3.0, 1e-12);
}

// A paddle that starts at once hits with its speed; one that accelerates evenly, with the speed at
// the time of the impact.
TEST(Kinematic, APaddleHitsWithItsSpeed) {
  const Material elastic{0.0, 1.0};
  for (const double dt : {1.0 / 60.0, 1.0 / 240.0, 0.001}) {
    for (const bool at_once : {true, false}) {
      WorldDesc desc;
      desc.gravity = {};
      World world(desc);
      const BodyId paddle = add_kinematic(world, Box{{0.1, 0.5, 0.5}}, {}, elastic);
      const double gap = 0.37;
      const BodyId ball = add_dynamic(
          world, {.shape = Sphere{0.1}, .material = elastic, .pose = SE3(Vec3{0.2 + gap, 0, 0})});
      double expected = 4.0;
      if (at_once) {
        must(world.set_velocity_world(paddle, {{2.0, 0, 0}, {}}));
        run(world, 0.5, dt);
      } else {
        const double acceleration = 10.0;
        expected = 2.0 * std::sqrt(2.0 * acceleration * gap);
        follow(
            world, paddle, {1, 0, 0}, [&](double t) { return 0.5 * acceleration * t * t; }, 0.3,
            dt);
      }
      const double speed = world.velocity_world(ball).linear.x;
      std::printf("%s, %4.0f Hz: %.4f m/s, expected %.4f\n", at_once ? "at once" : "evenly",
                  1.0 / dt, speed, expected);
      EXPECT_NEAR(speed, expected, at_once ? 1e-4 : 0.03 * expected);
    }
  }
}

// Something without friction and restitution before a pusher, in its way along x.
struct Push {
  World world{weightless()};
  BodyId pusher = add_kinematic(world, Box{{0.1, 0.5, 0.5}}, {}, {0.0, 0.0});
  BodyId body;

  Push(const Shape& shape, double x)
      : body(add_dynamic(world,
                         {.shape = shape, .material = {0.0, 0.0}, .pose = SE3(Vec3{x, 0, 0})})) {}
  void step(double speed, double dt) {
    must(world.set_velocity_world(pusher, {{speed, 0, 0}, {}}));
    must(world.step(dt));
  }
  double speed() const { return world.velocity_world(body).linear.x; }
};

// However it gathers speed, it throws a body that does not bounce at hardly more than its speed.
TEST(Kinematic, ThrowsWithItsSpeed) {
  for (const double dt : {1.0 / 60.0, 1.0 / 240.0}) {
    for (const int steps : {1, 2, 3, 10}) {
      Push push(Box{{0.1, 0.1, 0.1}}, 0.2);
      for (int i = 1; i <= 60; ++i) {
        const double speed = 10.0 * std::min(1.0, static_cast<double>(i) / steps);
        push.step(speed, dt);
      }
      EXPECT_NEAR(push.speed(), 10.0, 0.03 + 10.0 * dt) << steps;
    }
  }
}

// A paddle that slows down pushes a ball within a step and has lost it by the end of the step.
TEST(Kinematic, WhatItPushesWithinAStepIsReported) {
  int pushed = 0;
  for (int k = 0; k < 40; ++k) {
    Push push(Sphere{0.1}, 0.31 + 0.002 * k);
    int begun = 0;
    for (int i = 0; i < 20; ++i) {
      push.step(std::max(0.0, 4.0 - 0.25 * i), 1.0 / 60.0);
      for (const ContactEvent& event : push.world.contact_events())
        begun += event.kind == ContactEvent::Kind::begin ? 1 : 0;
    }
    const bool moves = push.speed() > 0.0;
    pushed += moves ? 1 : 0;
    EXPECT_EQ(begun > 0, moves) << k;
  }
  EXPECT_GT(pushed, 20);
}

// The last acceleration is part of the state.
TEST(Kinematic, ASnapshotKeepsItsAcceleration) {
  const auto make = [](World& world) {
    const BodyId plate = add_kinematic(world, Box{{1, 1, 0.1}}, {}, {.friction = 0.5});
    add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.2})});
    return plate;
  };
  const auto displacement = [](double t) { return 2.0 * t * t; };
  World world, other;
  const BodyId plate = make(world), copy = make(other);
  follow(world, plate, {1, 0, 0}, displacement, 0.1, 0.01);
  std::vector<std::byte> bytes;
  world.snapshot(bytes);
  must(other.restore(bytes));
  for (World* each : {&world, &other}) {
    follow(
        *each, each == &world ? plate : copy, {1, 0, 0},
        [&](double t) { return displacement(0.1 + t) - displacement(0.1); }, 0.1, 0.01);
  }
  EXPECT_EQ(world.state_hash(), other.state_hash());
}

}  // namespace
}  // namespace vp::test
