// Momentum, energies and generalised forces, each against an independent route.
#include "vphysics/multibody/quantities.h"

#include <gtest/gtest.h>

#include <cmath>

#include "screws_joint.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;

// Sums over the links, each in its own frame and about its own centre of mass.
struct Sums {
  double mass = 0, kinetic = 0, potential = 0;
  Vec3 first_moment{};
  dse3 momentum{};  // about the world's origin
};
Sums sum_over_links(const Model& model, const Data& data, const Vec3& gravity) {
  Sums sums;
  for (int l = 0; l < model.links(); ++l) {
    const Inertia& J = model.link(l).inertia;
    bool moves = false;
    for (int i = l; i != kWorld; i = model.link(i).parent) {
      moves |= velocities_of(model.link(i).joint) > 0;
    }
    if (!moves) continue;
    const SE3 T = T_world_link<double>(model, data, l);
    const se3 V = link_velocity<double>(model, data, l);
    const Vec3 c = J.centre_of_mass(), u = V.v + cross(V.w, c);
    const Vec3 spin = J.central() * V.w, x = T * c, p = J.mass() * T.rotate(u);
    sums.mass += J.mass();
    sums.first_moment += J.mass() * x;
    sums.momentum = sums.momentum + dse3{T.rotate(spin) + cross(x, p), p};
    sums.kinetic += 0.5 * J.mass() * dot(u, u) + 0.5 * dot(V.w, spin);
    sums.potential -= J.mass() * dot(gravity, x);
  }
  return sums;
}
double size(const dse3& F) {
  return norm(F.m) + norm(F.f);
}

// Measured: 5e-15 of the largest.
TEST(Quantities, AreTheSumsOverTheLinks) {
  Random random(91);
  for (int round = 0; round < 100; ++round) {
    const Model model = tree_with_screws(random, 12);
    const State s = random_state(random, model);
    Data data(model);
    forward_kinematics<double>(model, data, s.q, s.v);
    const Vec3 gravity = random.in_cube(10);
    const Sums sums = sum_over_links(model, data, gravity);
    const Vec3 centre = (1 / sums.mass) * sums.first_moment;
    const double bound = 1e-13 * (1 + size(sums.momentum) + sums.kinetic);
    ASSERT_NEAR(total_mass(model), sums.mass, 1e-13 * sums.mass);
    ASSERT_LT(norm(centre_of_mass<double>(model, data) - centre), 1e-13 * (1 + norm(centre)));
    ASSERT_LT(
        norm(centre_of_mass_velocity<double>(model, data) - (1 / sums.mass) * sums.momentum.f),
        bound);
    ASSERT_LT(size(momentum<double>(model, data, {}) - sums.momentum), bound);
    const dse3 central{sums.momentum.m - cross(centre, sums.momentum.f), sums.momentum.f};
    ASSERT_LT(size(momentum<double>(model, data, centre) - central), bound);
    ASSERT_NEAR(kinetic_energy<double>(model, data), sums.kinetic, bound);
    ASSERT_NEAR(potential_energy<double>(model, data, gravity), sums.potential,
                1e-13 * (1 + std::fabs(sums.potential) + 10 * norm(sums.first_moment)));
  }
}

TEST(Quantities, KineticEnergyIsHalfTheMassMatrixBetweenTheVelocities) {
  Random random(92);
  for (int round = 0; round < 50; ++round) {
    const Model model = tree_with_screws(random, 12);
    const State s = random_state(random, model);
    const std::size_t n = s.v.size();
    Data data(model);
    Numbers M(n * n);
    mass_matrix<double>(model, data, s.q, M);
    double expected = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < n; ++k) expected += 0.5 * s.v[i] * M[i * n + k] * s.v[k];
      expected -= 0.5 * 0.05 * s.v[i] * s.v[i];  // the armature of every joint of these trees
    }
    forward_kinematics<double>(model, data, s.q, s.v);
    ASSERT_NEAR(kinetic_energy<double>(model, data), expected, 1e-12 * (1 + expected));
  }
}

// Along q, with the order of the difference quotient.
TEST(GravityForces, AreTheSlopeOfThePotentialEnergy) {
  Random random(93);
  for (int round = 0; round < 8; ++round) {
    const Model model = tree_with_screws(random, 8);
    const State s = random_state(random, model);
    const std::size_t n = s.v.size();
    const Vec3 gravity = random.in_cube(10);
    Data data(model);
    Numbers g(n), h(n);
    gravity_forces<double>(model, data, s.q, gravity, g);
    double errors[2] = {};
    for (std::size_t k = 0; k < n; ++k) {
      const auto energy = [&](double step) {
        Numbers delta(n);
        delta[k] = step;
        forward_kinematics<double>(model, data, stepped(model, s.q, delta), s.v);
        return potential_energy<double>(model, data, gravity);
      };
      for (int i = 0; i < 2; ++i) {
        const double step = i == 0 ? 2e-3 : 1e-3;
        errors[i] =
            std::max(errors[i], std::fabs((energy(step) - energy(-step)) / (2 * step) - g[k]));
      }
    }
    ASSERT_LT(errors[1], 1e-4 * (1 + largest_of(g)));
    ASSERT_NEAR(errors[0] / errors[1], 4.0, 0.1) << round;
  }
}

TEST(BiasForces, AreWhatNoAccelerationTakes) {
  Random random(94);
  for (int round = 0; round < 20; ++round) {
    const Model model = random_tree(random, 12);
    State s = random_state(random, model);
    std::vector<dse3> external(static_cast<std::size_t>(model.links()));
    for (dse3& F : external) F = {random.in_cube(1), random.in_cube(1)};
    const Loads loads{.gravity = random.in_cube(10), .external = external};
    Data data(model);
    Numbers h(s.v.size()), a(s.v.size());
    bias_forces<double>(model, data, s.q, s.v, loads, h);
    ASSERT_TRUE(forward_dynamics<double>(model, data, s.q, s.v, h, loads, a));
    ASSERT_LT(largest_of(a), 1e-11 * (1 + largest_of(h)));
    ASSERT_GT(largest_of(h), 1.0);
  }
}

// Newton's and Euler's equations for the entire tree about its centre of mass, along the motion by
// forward dynamics: only gravity acts on a floating tree.
TEST(Momentum, OfAFloatingTreeChangesByGravityAlone) {
  Random random(95);
  for (int round = 0; round < 20; ++round) {
    ModelBuilder builder;
    must_build(builder.add({"body", kWorld, FreeJoint{}, random.pose(1), random_body(random)}));
    for (int i = 1; i < 8; ++i) {
      must_build(
          builder.add({"link", static_cast<int>(random.word() % static_cast<unsigned>(i)),
                       random_joint(random, i % 10), random.pose(0.5), random_body(random)}));
    }
    const Model model = must_build(builder.build());
    State s = random_state(random, model);
    for (std::size_t k = 0; k < 6; ++k) s.tau[k] = 0.0;
    const Vec3 gravity = random.in_cube(10);
    Data data(model);
    Numbers a(s.v.size());
    ASSERT_TRUE(forward_dynamics<double>(model, data, s.q, s.v, s.tau, {.gravity = gravity}, a));
    const auto central = [&](double h) {
      // To second order in h; the central difference cancels the odd part of the error.
      Numbers v = s.v, middle = s.v;
      for (std::size_t k = 0; k < v.size(); ++k) {
        v[k] += h * a[k];
        middle[k] += 0.5 * h * a[k];
      }
      forward_kinematics<double>(model, data, stepped(model, s.q, middle, h), v);
      return momentum<double>(model, data, centre_of_mass<double>(model, data));
    };
    double errors[2];
    for (int i = 0; i < 2; ++i) {
      const double h = i == 0 ? 2e-3 : 1e-3;
      const dse3 slope = (0.5 / h) * (central(h) - central(-h));
      errors[i] = size(slope - dse3{{}, total_mass(model) * gravity});
    }
    ASSERT_LT(errors[1], 1e-2);
    ASSERT_NEAR(errors[0] / errors[1], 4.0, 0.2) << round;
  }
}

TEST(MomentumMatrix, TimesTheVelocitiesIsTheMomentum) {
  Random random(96);
  for (int round = 0; round < 50; ++round) {
    const Model model = tree_with_screws(random, 12);
    const State s = random_state(random, model);
    Data data(model);
    forward_kinematics<double>(model, data, s.q, s.v);
    const Vec3 centre = centre_of_mass<double>(model, data);
    std::vector<dse3> A(s.v.size());
    std::vector<Vec3> J(s.v.size());
    for (const Vec3& about : {Vec3{}, centre}) {
      momentum_matrix<double>(model, data, about, A);
      dse3 sum{};
      for (std::size_t k = 0; k < A.size(); ++k) sum = sum + s.v[k] * A[k];
      const dse3 expected = momentum<double>(model, data, about);
      ASSERT_LT(size(sum - expected), 1e-13 * (1 + size(expected)));
    }
    centre_of_mass_jacobian<double>(model, data, J);
    Vec3 sum{};
    for (std::size_t k = 0; k < J.size(); ++k) {
      sum += s.v[k] * J[k];
      // The linear rows of the momentum matrix are the Jacobian times the mass.
      ASSERT_LT(norm(A[k].f - total_mass(model) * J[k]), 1e-13 * (1 + norm(A[k].f)));
    }
    const Vec3 u = centre_of_mass_velocity<double>(model, data);
    ASSERT_LT(norm(sum - u), 1e-13 * (1 + norm(u)));
  }
}

// Gravity forces by two more routes: the weight through the Jacobian of the centre of mass.
TEST(GravityForces, AreTheWeightAtTheCentreOfMass) {
  Random random(97);
  for (int round = 0; round < 20; ++round) {
    const Model model = tree_with_screws(random, 12);
    const State s = random_state(random, model);
    const Vec3 gravity = random.in_cube(10);
    Data data(model);
    Numbers g(s.v.size());
    gravity_forces<double>(model, data, s.q, gravity, g);
    std::vector<Vec3> J(s.v.size());
    centre_of_mass_jacobian<double>(model, data, J);
    for (std::size_t k = 0; k < J.size(); ++k) {
      ASSERT_NEAR(g[k], -total_mass(model) * dot(gravity, J[k]), 1e-12 * (1 + largest_of(g)));
    }
  }
}

TEST(Quantities, OfFloatsAndOfLanesAreThoseOfDoubles) {
  Random random(98);
  const Model model = random_tree(random, 12);
  const ModelT<float> narrow(model);
  using P = PackT<double, 4>;
  Data data(model);
  DataT<float> floats(narrow);
  DataT<P> lanes(model);
  const State s = random_state(random, model);
  const std::vector<float> qf(s.q.begin(), s.q.end()), vf(s.v.begin(), s.v.end());
  const std::vector<P> qp(s.q.begin(), s.q.end()), vp(s.v.begin(), s.v.end());
  forward_kinematics<double>(model, data, s.q, s.v);
  forward_kinematics<float>(narrow, floats, qf, vf);
  forward_kinematics<P>(model, lanes, qp, vp);
  const double energy = kinetic_energy<double>(model, data);
  EXPECT_NEAR(static_cast<double>(kinetic_energy<float>(narrow, floats)), energy, 1e-5 * energy);
  EXPECT_NEAR((kinetic_energy<P>(model, lanes)[2]), energy, 1e-13 * energy);
  const dse3 p = momentum<double>(model, data, {});
  EXPECT_NEAR(static_cast<double>(momentum<float>(narrow, floats, {}).m.x), p.m.x, 1e-4);
  EXPECT_NEAR((momentum<P>(model, lanes, {}).m.x[3]), p.m.x, 1e-12);
  EXPECT_NEAR(static_cast<double>(total_mass(narrow)), total_mass(model), 1e-5);
}

}  // namespace
}  // namespace vp::test
