// Articulations whose links rotate far within a step: no energy out of velocity-dependent forces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "random.h"
#include "rig.h"

namespace vp::test {
namespace {

enum class Kind { balls, hinges, balls_on_free_root };
const char* const kNames[] = {"ball joints", "hinges", "ball joints on a free root"};

const Inertia kLink = solid_inertia(Box{{0.25, 0.05, 0.1}}, 1000.0).InvXform(SE3(Vec3{0.25, 0, 0}));

// Three links in a row with random velocities of up to max_rate.
struct Chain {
  World world;
  ArticulationId id;

  Chain(Kind kind, double max_rate) {
    ModelBuilder builder;
    for (int i = 0; i < 3; ++i) {
      LinkSpec link;
      link.name = "link" + std::to_string(i);
      link.parent = i == 0 ? kWorld : i - 1;
      link.joint = BallJoint{};
      if (kind == Kind::hinges) link.joint = RevoluteJoint{i == 1 ? Vec3{0, 0, 1} : Vec3{0, 1, 0}};
      if (kind == Kind::balls_on_free_root && i == 0) link.joint = FreeJoint{};
      if (i > 0) link.T_parent_joint = SE3(Vec3{0.5, 0, 0});
      link.inertia = kLink;
      must(builder.add(link));
    }
    const Model model = must(builder.build());
    std::vector<double> v(static_cast<std::size_t>(model.velocities()));
    id = must(world.create_articulation({model}));
    Random random(5);
    for (double& rate : v) rate = max_rate * random.uniform(-1, 1);
    if (kind == Kind::balls_on_free_root) std::fill(v.begin() + 3, v.begin() + 6, 0.0);
    must(world.set_joint_states(id, model.zero_coordinates(), v));
  }
  double energy() const {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      const BodyId body = world.link_body(id, i);
      const se3 V = world.velocity(body);
      sum += 0.5 * (V * (kLink * V)) +
             kLink.mass() * kG * (world.pose(body) * kLink.centre_of_mass()).z;
    }
    return sum;
  }
};

TEST(FastTrees, StayBoundedHoweverFar) {
  for (const Kind kind : {Kind::balls, Kind::hinges, Kind::balls_on_free_root}) {
    for (const double rate : {30.0, 100.0, 300.0}) {
      for (const double hz : {60.0, 240.0, 1000.0}) {
        Chain chain(kind, rate);
        const double start = chain.energy();
        double most = 1.0;
        for (int i = 0; i < std::lround(5.0 * hz); ++i) {
          EXPECT_FALSE(must(chain.world.step(1.0 / hz)).non_finite);
          most = std::max(most, chain.energy() / start);
        }
        const char* const name = kNames[static_cast<int>(kind)];
        std::printf("%s, %3.0f rad/s, %4.0f Hz: energy up to %.3f\n", name, rate, hz, most);
        const double turn = rate / hz;  // in a step [rad]
        EXPECT_LT(most, turn < 0.15 ? 1.4 : 40.0) << name << ' ' << rate << ' ' << hz;
      }
    }
  }
}

// A top on a ball joint: half a radian and more in a step.
TEST(FastTrees, ThatSpinKeepTheirEnergy) {
  for (const double spin : {60.0, 200.0}) {
    for (const double hz : {60.0, 120.0, 240.0}) {
      World world;
      ModelBuilder builder;
      LinkSpec link;
      link.name = "top";
      link.joint = BallJoint{};
      const SE3 at(Exp(Vec3{0, 0.5 * kPi, 0}), Vec3{1, 0, 0});
      const Inertia J = solid_inertia(Cylinder{0.5, 0.05}, 1000.0).InvXform(at);
      link.inertia = J;
      must(builder.add(link));
      const ArticulationId id = must(world.create_articulation({must(builder.build())}));
      const std::vector<double> q{0, 0, 0, 1}, v{spin, 0, kG / (0.125 * spin)};
      must(world.set_joint_states(id, q, v));
      const auto energy = [&] {
        const se3 V = world.velocity(world.link_body(id, 0));
        return 0.5 * (V * (J * V)) +
               J.mass() * kG * (world.pose(world.link_body(id, 0)) * Vec3{1, 0, 0}).z;
      };
      const double start = energy();
      for (int i = 0; i < std::lround(5.0 * hz); ++i) must(world.step(1.0 / hz));
      EXPECT_NEAR(energy(), start, 0.01 * start) << spin << ' ' << hz;
    }
  }
}

}  // namespace
}  // namespace vp::test
