// Conservation laws of many bodies: momentum stays constant, and energy never grows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "joints_rig.h"
#include "random.h"

namespace vp::test {
namespace {

struct Sums {
  Vec3 momentum, angular;  // world frame, about its origin
  double energy = 0.0;     // kinetic and potential energy [J]
};
Sums sums_of(const World& world, const std::vector<BodyId>& bodies, const Vec3& gravity) {
  Sums sums;
  for (const BodyId body : bodies) {
    const SE3 T = world.pose(body);
    const se3 V = world.velocity(body);
    const Inertia J = world.inertia(body);
    const dse3 P = J * V;
    const Vec3 p = T.rotate(P.f);
    sums.momentum += p;
    sums.angular += T.rotate(P.m) + cross(T.position(), p);
    sums.energy += 0.5 * (V * P) - J.mass() * dot(gravity, T.position());
  }
  return sums;
}

Shape shape_of(int i) {
  switch (i % 5) {
    case 0:
      return Sphere{0.15};
    case 1:
      return Capsule{0.1, 0.1};
    case 2:
      return Cylinder{0.12, 0.1};
    case 3:
      return Cone{0.15, 0.15};
    default:
      return Box{{0.12, 0.1, 0.15}};
  }
}

// A cloud of all shapes collapses onto itself, with friction and restitution; some bodies are
// joined. Contacts are solved in single precision: measured 1.3e-7 of the momentum, and 3e-4 of the
// angular momentum with the error of integrating rotations.
TEST(Momentum, OfManyThatCollideIsKept) {
  World world(weightless());
  Random random(17);
  std::vector<BodyId> bodies;
  double moving = 0.0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 at = random.in_cube(1.2);
    Part part{.shape = shape_of(i),
              .material = {0.5, 0.4, 0.001},
              .pose = SE3(random.rotation(), at),
              .velocity = {random.in_cube(5.0), {}}};
    bodies.push_back(add_dynamic(world, part));
    const Vec3 inwards = -2.0 * at + Vec3{0.3, 0, 0};
    must(world.set_velocity(bodies.back(), {part.velocity.w, part.pose.unrotate(inwards)}));
    moving += world.inertia(bodies.back()).mass() * norm(inwards);
  }
  for (std::size_t i = 0; i + 1 < 20; i += 2) {
    join(world, bodies[i], bodies[i + 1], BallSocket{}, world.pose(bodies[i]));
  }
  const Sums before = sums_of(world, bodies, {});
  std::uint32_t hits = 0;
  for (int i = 0; i < 1000; ++i) {
    must(world.step(0.002));
    hits += static_cast<std::uint32_t>(world.contact_events().size());
  }
  EXPECT_GT(hits, 100u);
  const Sums after = sums_of(world, bodies, {});
  std::printf("momentum off by %.2g, angular by %.2g of %.3g kg m/s\n",
              norm(after.momentum - before.momentum), norm(after.angular - before.angular), moving);
  EXPECT_LT(norm(after.momentum - before.momentum), 1e-5 * moving);
  EXPECT_LT(norm(after.angular - before.angular), 1e-3 * moving);
}

// All shapes are poured into a pit, at each rate and restitution. At no step is the energy above
// that of any earlier step, except for what the penetration of a hard impact returns: measured
// 1.2e-4 of the initial energy.
TEST(Energy, OfAllShapesPouredIntoAPitNeverGrows) {
  for (const double rate : {60.0, 240.0, 1000.0}) {
    for (const double restitution : {0.0, 0.5, 1.0}) {
      World world;
      const Material m{0.5, restitution, 0.0};
      add_ground(world, m);
      for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}}) {
        const Vec3 t = cross(Vec3{0, 0, 1}, n);
        add_fixed(world, HalfSpace{}, m, SE3(Mat3{t, cross(n, t), n}, -0.8 * n));
      }
      Random random(23);
      std::vector<BodyId> bodies;
      for (int i = 0; i < 40; ++i) {
        const Vec3 at{0.5 * (i % 3 - 1), 0.5 * (i / 3 % 3 - 1), 0.4 + 0.4 * (i / 9)};
        bodies.push_back(add_dynamic(
            world, {.shape = shape_of(i), .material = m, .pose = SE3(random.rotation(), at)}));
      }
      const Vec3 gravity{0, 0, -9.81};
      const double start = sums_of(world, bodies, gravity).energy;
      double least = start, worst = 0.0;
      for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) {
        must(world.step(1.0 / rate));
        const double now = sums_of(world, bodies, gravity).energy;
        worst = std::max(worst, (now - least) / start);
        least = std::min(least, now);
      }
      std::printf("%4.0f Hz, restitution %.1f: %.3f of the energy left, grew by %.2g at most\n",
                  rate, restitution, least / start, worst);
      EXPECT_LT(worst, 0.001) << rate << " Hz, restitution " << restitution;
    }
  }
}

// A stack far from the origin stands as one at the origin does. At a thousand kilometres, positions
// have a spacing of 1.2e-10 m. While the boxes still rock, this sometimes decides whether a contact
// has settled: measured 0.2 mm. Single precision would have a spacing of 62 mm.
TEST(LargeWorlds, AStackAThousandKilometresAwayStandsAsAtTheOrigin) {
  const auto fall = [](const Vec3& origin) {
    World world;
    add_fixed(world, HalfSpace{}, {0.6, 0.0, 0.0}, SE3(origin));
    std::vector<BodyId> boxes;
    for (int i = 0; i < 8; ++i) {
      boxes.push_back(
          add_dynamic(world, {.shape = Box{{0.5, 0.5, 0.5}},
                              .material = {0.6, 0.0, 0.0},
                              .pose = SE3(origin + Vec3{0.0625 * (i % 2), 0, 0.5 + 1.03125 * i})}));
    }
    run(world, 5.0, 1.0 / 256);
    std::vector<Vec3> at;
    for (const BodyId box : boxes) at.push_back(world.pose(box).position() - origin);
    return at;
  };
  const auto here = fall({});
  double worst = 0.0;
  for (const Vec3& origin : {Vec3{1e6, -1e6, 1e6}, Vec3{1048576, 0, 0}, Vec3{0, 1e5, 0}}) {
    const auto there = fall(origin);
    for (std::size_t i = 0; i < here.size(); ++i) {
      worst = std::max(worst, norm(there[i] - here[i]));
    }
  }
  std::printf("boxes end within %.2g m of where they do at the origin\n", worst);
  EXPECT_LT(worst, 1e-3);
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_NEAR(here[i].z, 0.5 + 1.0 * static_cast<double>(i), 2e-3);
  }
}

}  // namespace
}  // namespace vp::test
