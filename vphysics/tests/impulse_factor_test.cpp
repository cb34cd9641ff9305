// The square root of a tree's inverse mass matrix, against the model's own passes.
#include "multibody/impulse_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "multibody/kinematics.h"
#include "trees.h"
#include "vphysics/multibody/dynamics.h"

namespace vp::test {
namespace {

constexpr int kTrees = 40;
constexpr int kJointKinds = 9;  // of joints: all but user-defined ones

// A tree in some state, and its factor.
struct Factored {
  Factored(Random& random, int links)
      : model(random_tree(random, links, kJointKinds)),
        state(random_state(random, model)),
        data(model),
        factor(model) {
    forward_kinematics<double>(model, data, state.q, state.v);
    fine = factor.factor(model, data);
    factor.twists(state.v);
  }
  std::size_t size() const { return state.v.size(); }
  double damping(int link) const { return model.link(link).damping; }

  Model model;
  State state;
  Data data;
  detail::ImpulseFactor factor;
  bool fine = false;
};

// At zero acceleration, inverse dynamics gives the bias forces, which here also include damping.
TEST(ImpulseFactor, BiasIsWhatInverseDynamicsSaysOfNoAcceleration) {
  Random random(41);
  for (int k = 0; k < kTrees; ++k) {
    Factored c(random, 1 + k % 20);
    ASSERT_TRUE(c.fine);
    const Vec3 gravity{0.3, -1.0, -9.81};
    std::vector<double> bias(c.size()), expected(c.size());
    const std::vector<double> none(c.size());
    c.factor.bias(gravity, bias);
    inverse_dynamics<double>(c.model, c.data, c.state.q, c.state.v, none, {.gravity = gravity},
                             expected);
    for (int link = 0; link < c.model.links(); ++link) {
      const int first = c.model.first_velocity(link);
      for (int d = 0; d < velocities_of(c.model.link(link).joint); ++d) {
        const auto i = static_cast<std::size_t>(first + d);
        expected[i] -= c.damping(link) * c.state.v[i];
      }
    }
    const double scale = 1.0 + largest_of(expected);
    for (std::size_t i = 0; i < bias.size(); ++i) {
      EXPECT_NEAR(bias[i], expected[i], 1e-11 * scale) << "tree " << k << ", velocity " << i;
    }
  }
}

// With loads on links: the solved accelerations equal those of forward dynamics.
TEST(ImpulseFactor, AccelerationsAreThoseOfForwardDynamics) {
  Random random(42);
  for (int k = 0; k < kTrees; ++k) {
    Factored c(random, 1 + k % 20);
    const Vec3 gravity{0.0, 0.0, -9.81};
    // Loads in the links' frames, as forward_dynamics() takes them, and the same loads in the world
    // frame.
    std::vector<dse3> loads(static_cast<std::size_t>(c.model.links()));
    std::vector<double> force = c.state.tau, bias(c.size()), expected(c.size());
    for (int link = 0; link < c.model.links(); ++link) {
      const SE3 T = T_world_link(c.model, c.data, link);
      const dse3 load{random.in_cube(3.0), random.in_cube(3.0)};
      loads[static_cast<std::size_t>(link)] = {T.unrotate(load.m), T.unrotate(load.f)};
      c.factor.add_load(link, T.position(), load, force);
    }
    c.factor.bias(gravity, bias);
    for (std::size_t i = 0; i < force.size(); ++i) force[i] -= bias[i];
    for (int link = 0; link < c.model.links(); ++link) {
      const int first = c.model.first_velocity(link);
      for (int d = 0; d < velocities_of(c.model.link(link).joint); ++d) {
        const auto i = static_cast<std::size_t>(first + d);
        force[i] -= c.damping(link) * c.state.v[i];
      }
    }
    c.factor.solve(force);
    forward_dynamics<double>(c.model, c.data, c.state.q, c.state.v, c.state.tau,
                             {.gravity = gravity, .external = loads}, expected);
    const double scale = 1.0 + largest_of(expected);
    for (std::size_t i = 0; i < force.size(); ++i) {
      EXPECT_NEAR(force[i], expected[i], 1e-9 * scale) << "tree " << k << ", velocity " << i;
    }
  }
}

TEST(ImpulseFactor, ThreeRowsAtOnceAreThoseOfOneEach) {
  Random random(43);
  for (int k = 0; k < kTrees; ++k) {
    const Factored c(random, 1 + k % 20);
    for (int link = 0; link < c.model.links(); ++link) {
      const Vec3 ways[] = {{0.6, 0.0, -0.8}, {0.0, 1.0, 0.0}, {0.8, 0.1, 0.6}};
      const Vec3 point{0.3, -0.2, 0.1 * k};
      const std::size_t depth = c.factor.depth(link);
      std::vector<double> forces(3 * depth), moments(3 * depth), one(depth);
      c.factor.force_rows(link, point, ways, forces.data());
      c.factor.moment_rows(link, ways, moments.data());
      for (std::size_t way = 0; way < 3; ++way) {
        c.factor.force_row(link, point, ways[way], one.data());
        for (std::size_t i = 0; i < depth; ++i) EXPECT_EQ(forces[way * depth + i], one[i]);
        c.factor.moment_row(link, ways[way], one.data());
        for (std::size_t i = 0; i < depth; ++i) EXPECT_EQ(moments[way * depth + i], one[i]);
      }
    }
  }
}

// Every free root has moved, and all velocities have changed.
TEST(ImpulseFactor, KinematicsOfMovedRootsAreThoseOfForwardKinematics) {
  Random random(44);
  int moved = 0;
  for (int k = 0; k < kTrees; ++k) {
    const Factored c(random, 1 + k % 20);
    std::vector<double> q = c.state.q;
    for (const auto& node : c.model.tree().nodes) {
      if (!node.free_root()) continue;
      for (int i = 0; i < 3; ++i) q[static_cast<std::size_t>(node.q + i)] += 0.1 * (i + 1);
      ++moved;
    }
    std::vector<double> v = c.state.v;
    for (double& x : v) x = 0.7 * x - 0.1;
    Data data(c.model, Arithmetic::reproducible), whole(c.model, Arithmetic::reproducible);
    forward_kinematics<double>(c.model, data, c.state.q, c.state.v);
    detail::ImpulseFactor::kinematics_of(c.model, data, q, v);
    forward_kinematics<double>(c.model, whole, q, v);
    for (int link = 0; link < c.model.links(); ++link) {
      EXPECT_TRUE(T_world_link(c.model, data, link) == T_world_link(c.model, whole, link));
    }
    for (int node = 0; node < static_cast<int>(c.model.tree().nodes.size()); ++node) {
      EXPECT_TRUE(detail::velocity_of(data.work(), node) ==
                  detail::velocity_of(whole.work(), node));
    }
  }
  EXPECT_GT(moved, 5);
}

}  // namespace
}  // namespace vp::test
