// Bodies that rotate bounce off planes and off each other, without friction and without continuous
// collision. With restitution 1 they keep their energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "random.h"
#include "rig.h"
#include "vphysics/compound.h"
#include "vphysics/convex_hull.h"

namespace vp::test {
namespace {

constexpr Material kBouncy{0.0, 1.0};

struct Tumbler {
  const char* name;
  Shape shape;
  // Of the energy, after a bounce off a plane at 60 Hz: what is left in the mean, and the largest
  // gain; and what is left after 5 s among others at 60 Hz.
  double mean = 0.992, gain = 0.16, left = 0.95;
};
std::vector<Tumbler> tumblers() {
  const std::vector<Vec3> corners{
      {0.15, 0, -0.1}, {-0.1, 0.12, -0.08}, {-0.1, -0.12, -0.08}, {0, 0, 0.2}};
  const std::vector<CompoundPart> balls{{Sphere{0.08}, SE3(Vec3{0, 0, 0.15})},
                                        {Sphere{0.08}, SE3(Vec3{0, 0, -0.15})}};
  return {{"capsule", Capsule{0.1, 0.15}},
          {"box", Box{{0.1, 0.1, 0.15}}},
          {"plank", Box{{0.02, 0.1, 0.3}}, 0.955, 0.8, 0.73},
          {"cylinder", Cylinder{0.1, 0.15}},
          {"cone", Cone{0.12, 0.15}},
          {"hull", must(ConvexHull::of(corners))},
          {"dumb-bell", must(Compound::of(balls)), 0.992, 0.25, 0.9}};
}

double energy_of(const World& world, BodyId body) {
  return kinetic_energy(world, body, world.inertia(body));
}

TEST(Bounces, OffAPlaneKeepTheEnergy) {
  for (const Tumbler& tumbler : tumblers()) {
    for (const double rate : {3.0, 10.0, 30.0}) {
      Random random(2101);
      double most = 0.0, sum = 0.0;
      constexpr int kThrows = 100;
      for (int k = 0; k < kThrows; ++k) {
        World world({.gravity = {}});
        add_ground(world, kBouncy);
        Part part;
        part.shape = tumbler.shape;
        part.material = kBouncy;
        const Mat3 R = random.rotation();
        part.pose = SE3(R, {0, 0, random.uniform(0.7, 1.3)});
        const BodyId body = add_dynamic(world, part);
        const Vec3 along = random.in_cube(2.0), turning = random.in_cube(rate);
        must(world.set_velocity_world(body, {{along.x, along.y, -5}, turning}));
        const double start = energy_of(world, body);
        for (int i = 0; i < 30; ++i) must(world.step(1.0 / 60));
        const double ratio = energy_of(world, body) / start;
        sum += ratio;
        most = std::max(most, ratio);
      }
      EXPECT_GT(sum / kThrows, tumbler.mean) << tumbler.name << ", " << rate << " rad/s";
      EXPECT_LT(most, 1.0 + tumbler.gain) << tumbler.name << ", " << rate << " rad/s";
    }
  }
}

// The fraction of the energy of 27 that bounce off each other and off walls which is left after 5
// s.
double left_after_bounces(const Tumbler& tumbler, double rate, std::uint64_t seed) {
  constexpr int kSide = 3;
  constexpr double kHalf = 2.0, kPitch = 2.0 * kHalf / kSide;
  World world({.gravity = {}});
  Random random(seed);
  add_walls(world, kHalf, 0.2, kBouncy);
  std::vector<BodyId> bodies;
  double start = 0.0, end = 0.0;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const auto along = [&](int k) { return kPitch * (k % kSide + 0.5) - kHalf; };
    Part part;
    part.shape = tumbler.shape;
    part.material = kBouncy;
    part.pose = SE3(Vec3{along(i), along(i / kSide), along(i / kSide / kSide)});
    const Vec3 turning = random.in_cube(10.0), moving = random.in_cube(5.0);
    part.velocity = {turning, moving};
    bodies.push_back(add_dynamic(world, part));
    start += energy_of(world, bodies.back());
  }
  for (int i = 0; i < static_cast<int>(5.0 * rate); ++i) must(world.step(1.0 / rate));
  for (const BodyId body : bodies) end += energy_of(world, body);
  return end / start;
}

// Rare bounces change the energy by some percent: the mean over several starts, in long steps.
TEST(Bounces, OffEachOtherKeepTheEnergy) {
  for (const Tumbler& tumbler : tumblers()) {
    for (const double rate : kRates) {
      const int starts = rate < 100.0 ? 8 : 1;
      double left = 0.0;
      for (int k = 0; k < starts; ++k)
        left += left_after_bounces(tumbler, rate, 2102 + static_cast<std::uint64_t>(k)) / starts;
      const double least = rate < 100.0 ? tumbler.left : rate < 300.0 ? 0.98 : 0.998;
      EXPECT_GT(left, least) << tumbler.name << ", " << rate << " Hz";
      EXPECT_LT(left, 1.001) << tumbler.name << ", " << rate << " Hz";
    }
  }
}

// A plane without friction has no torque about its normal. The box is nearly a cube.
TEST(Bounces, OffAPlaneKeepTheSpinAboutItsNormal) {
  Random random(2103);
  for (int k = 0; k < 100; ++k) {
    World world({.gravity = {}});
    add_ground(world, kBouncy);
    Part part;
    part.shape = Box{{0.1, 0.1, 0.1002}};
    part.material = kBouncy;
    const Mat3 R = random.rotation();
    part.pose = SE3(R, {0, 0, random.uniform(0.7, 1.3)});
    const BodyId body = add_dynamic(world, part);
    must(world.set_velocity_world(body, {{0, 0, -5}, random.in_cube(30.0)}));
    const auto momentum = [&] {
      return world.pose(body).rotate(world.inertia(body).central() * world.velocity(body).w);
    };
    const Vec3 start = momentum();
    for (int i = 0; i < 30; ++i) must(world.step(1.0 / 60));
    EXPECT_NEAR(momentum().z, start.z, 0.01 * norm(start));
  }
}

// A corner that got a larger impulse than the others would make it rotate: then it lands on one.
TEST(Bounces, OfWhatFallsFlatStayFlat) {
  for (const double rate : kRates) {
    for (const Vec3& half : {Vec3{0.1, 0.2, 0.1}, Vec3{0.5, 0.5, 0.05}, Vec3{0.1, 0.3, 0.4}}) {
      World world;
      add_ground(world, kRough);
      Part part;
      part.shape = Box{half};
      part.material = {0.5, 1.0};
      part.pose = SE3(Vec3{0, 0, 1.0 + half.z});
      const BodyId box = add_dynamic(world, part);
      int bounces = 0;
      bool falls = true;
      for (int k = 0; bounces < 5 && k < static_cast<int>(6.0 * rate); ++k) {
        must(world.step(1.0 / rate));
        const VelocityWorld V = world.velocity_world(box);
        if (falls && V.linear.z > 0.0) ++bounces;
        falls = V.linear.z < 0.0;
        EXPECT_LT(norm(V.angular), 0.01);
      }
      EXPECT_EQ(bounces, 5) << rate << " Hz";
    }
  }
}

}  // namespace
}  // namespace vp::test
