// Properties of the variational integrator: it is symplectic and reversible, and conserves momentum
// to rounding and energy without drift, where the others drift.
#include <gtest/gtest.h>

#include <cmath>

#include "motions.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;

enum class Kind { euler, rk4, variational };

Expected<void> step(Kind kind, const Model& model, IntegratorData& data, Numbers& q, Numbers& v,
                    const StepT<double>& s) {
  if (kind == Kind::euler) return step_semi_implicit<double>(model, data, q, v, s);
  if (kind == Kind::rk4) return step_rk4<double>(model, data, q, v, s);
  const auto rounds = step_variational<double>(model, data, q, v, s);
  if (!rounds) return tl::make_unexpected(rounds.error());
  return {};
}

// Without damping, so that energy is conserved.
Model lossless_tree(Random& random, const std::vector<Joint>& joints) {
  ModelBuilder builder;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int parent = i < 3 ? static_cast<int>(i) - 1 : static_cast<int>(random.word() % i);
    must_build(builder.add({.parent = parent,
                            .joint = joints[i],
                            .T_parent_joint = random.pose(0.4),
                            .inertia = random_body(random)}));
  }
  return must_build(builder.build());
}
std::vector<Joint> all_joints(const Joint& root) {
  return {root,
          RevoluteJoint{{1, 2, 3}},
          BallJoint{},
          UniversalJoint{},
          HelicalJoint{{0, 1, 1}, 0.2},
          CylindricalJoint{{1, 0, 1}},
          std::make_shared<SliderOnACurve>(),
          PrismaticJoint{{0, 1, 0}},
          PlanarJoint{}};
}

// Mean energy error of the first and of the last tenth, and the largest of all.
struct Drift {
  double first = 0, last = 0, worst = 0, momentum = 0;
};
Drift drift_of(Kind kind, const Model& model, State s, const Vec3& gravity, double h, int steps) {
  IntegratorData data(model, Arithmetic::reproducible);  // the same figures on every machine
  Data other(model);
  const Mechanics begin = mechanics(model, other, s.q, s.v, gravity);
  Drift drift;
  const int tenth = steps / 10;
  for (int i = 0; i < steps; ++i) {
    const auto done = step(kind, model, data, s.q, s.v, {.h = h, .loads = {gravity, {}}});
    if (!done) {
      ADD_FAILURE() << done.error().message << " at " << i;
      return drift;
    }
    const Mechanics now = mechanics(model, other, s.q, s.v, gravity);
    const double error = now.energy() - begin.energy();
    if (i < tenth) drift.first += error / tenth;
    if (i >= steps - tenth) drift.last += error / tenth;
    drift.worst = std::max(drift.worst, std::fabs(error));
    drift.momentum =
        std::max(drift.momentum, size_of(now.momentum - begin.momentum) / size_of(begin.momentum));
  }
  return drift;
}

State at_rest(const Model& model) {
  State s;
  s.q = model.zero_coordinates();
  s.v.assign(static_cast<std::size_t>(model.velocities()), 0.0);
  return s;
}

// Measured: variational 1.2e-12 of momentum and at most 3e-5 J without drift. In 40 s Euler's
// energy grows by 18 J of 2 J; in 200 s RK4's falls by 3e-8 J.
TEST(Variational, KeepsATumblingBodysMomentumAndEnergyWhereOthersDrift) {
  const Model model = one_body(FreeJoint{}, Inertia(1.0, Vec3{0.2, 0.35, 0.5}));
  State s = at_rest(model);
  s.v = {0.5, 3.0, 1.0, 0.2, -0.1, 0.3};
  constexpr double kStep = 0.01;
  Drift drift[3];
  for (const Kind kind : {Kind::euler, Kind::rk4, Kind::variational}) {
    Drift& d = drift[static_cast<std::size_t>(kind)];
    d = drift_of(kind, model, s, {}, kStep, kind == Kind::euler ? 4000 : 20000);
    std::printf("first %.2e last %.2e worst %.2e momentum %.1e\n", d.first, d.last, d.worst,
                d.momentum);
  }
  EXPECT_GT(drift[0].last, 1e-2);                 // explicit in the body frame: it gains energy
  EXPECT_LT(drift[1].last, -1e-8);                // RK4 loses
  EXPECT_GT(drift[1].last / drift[1].first, 10);  // in proportion to time
  EXPECT_LT(drift[2].momentum, 3e-12);
  EXPECT_LT(std::fabs(drift[2].last - drift[2].first), 0.05 * drift[2].worst);
  EXPECT_LT(drift[2].worst, 1e-3);
}

// Every kind of joint on a floating root, a user-defined one included.
TEST(Variational, KeepsAFloatingTreesMomentumToRounding) {
  Random random(81);
  const Model model = lossless_tree(random, all_joints(FreeJoint{}));
  const State s = random_state(random, model);
  const Drift d = drift_of(Kind::variational, model, s, {}, 2e-3, 5000);
  const Drift rk4 = drift_of(Kind::rk4, model, s, {}, 2e-3, 5000);
  std::printf("momentum %.1e (RK4 %.1e), energy worst %.1e first %.1e last %.1e\n", d.momentum,
              rk4.momentum, d.worst, d.first, d.last);
  EXPECT_LT(d.momentum, 2e-12);  // measured: 1.3e-13
}

// A pendulum of three links on ball joints, in gravity. It is chaotic, so its numbers are fixed:
// random ones would depend on the compiler's order of evaluation. Measured after 40 s: RK4 has lost
// 1.4e-3 J in steps of 10 ms; the variational integrator, in steps of 2 ms, oscillates by 8e-4 J
// about a mean that moves by 3e-5 J.
TEST(Variational, EnergyHasNoTrendInGravity) {
  ModelBuilder builder;
  const Inertia link = Inertia(1.2, Vec3{0.02, 0.03, 0.04}).about({-0.05, 0.03, 0.25});
  for (int i = 0; i < 3; ++i) {
    must_build(builder.add({.parent = i - 1,
                            .joint = i < 2 ? Joint(BallJoint{}) : Joint(RevoluteJoint{{1, 0, 0}}),
                            .T_parent_joint = SE3(Vec3{0, 0.05, i == 0 ? 0.0 : -0.5}),
                            .inertia = link}));
  }
  const Model model = must_build(builder.build());
  State s = at_rest(model);
  s.v = {1, 2, 0.5, -1, 0.3, 1, 2};
  const Vec3 gravity{0, 0, -9.81};
  const Drift d = drift_of(Kind::variational, model, s, gravity, 2e-3, 20000);
  const Drift rk4 = drift_of(Kind::rk4, model, s, gravity, 1e-2, 4000);
  std::printf("worst %.1e first %.1e last %.1e; RK4 worst %.1e first %.1e last %.1e\n", d.worst,
              d.first, d.last, rk4.worst, rk4.first, rk4.last);
  EXPECT_LT(std::fabs(d.last - d.first), 0.1 * d.worst);
  EXPECT_GT(std::fabs(rk4.last), 0.5 * rk4.worst);  // the final error is the largest: a drift
}

// Forwards, with reversed velocities, and back again.
TEST(Variational, IsReversible) {
  Random random(83);
  const Model model = lossless_tree(random, all_joints(BallJoint{}));
  const State s = random_state(random, model);
  const StepT<double> h{.h = 2e-3};
  double off[2];
  for (const Kind kind : {Kind::euler, Kind::variational}) {
    IntegratorData data(model);
    Numbers q = s.q, v = s.v;
    for (int way = 0; way < 2; ++way) {
      for (int i = 0; i < 200; ++i) ASSERT_TRUE(step(kind, model, data, q, v, h));
      for (double& x : v) x = -x;
    }
    off[kind == Kind::variational] = distance(model, s.q, s.v, q, v);
  }
  std::printf("variational %.1e, Euler %.1e\n", off[1], off[0]);
  EXPECT_LT(off[1], 1e-11);
  EXPECT_GT(off[0], 1e-4);
}

// The step of a double pendulum as a map of (q, p), p = M(q) v: its Jacobian A, by central
// differences, satisfies A^T Omega A = Omega.
TEST(Variational, IsSymplectic) {
  Random random(84);
  const Model model = lossless_tree(random, {RevoluteJoint{{0, 1, 0}}, RevoluteJoint{{1, 0, 0.5}}});
  const State s = random_state(random, model);
  Data data(model);
  IntegratorData memory(model);
  const auto apply_mass = [&](const Numbers& q, const Numbers& v) {
    Numbers p(2), still(2);
    inverse_dynamics<double>(model, data, q, still, v, {.gravity = {}}, p);
    return p;
  };
  const auto off_symplectic = [&](Kind kind) {
    const Numbers p0 = apply_mass(s.q, s.v);
    const auto map = [&](std::size_t which, double change) {
      Numbers q = s.q, v = p0;
      (which < 2 ? q[which] : v[which - 2]) += change;
      EXPECT_TRUE(factor_mass<double>(model, data, q));
      solve_mass<double>(model, data, v);
      EXPECT_TRUE(step(kind, model, memory, q, v, {.h = 0.05}));
      const Numbers p = apply_mass(q, v);
      return Numbers{q[0], q[1], p[0], p[1]};
    };
    Numbers A[4];
    constexpr double kChange = 1e-5;
    for (std::size_t i = 0; i < 4; ++i) {
      const Numbers up = map(i, kChange), down = map(i, -kChange);
      for (std::size_t k = 0; k < 4; ++k) A[i].push_back((up[k] - down[k]) / (2 * kChange));
    }
    double worst = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        const double form =
            A[i][0] * A[j][2] + A[i][1] * A[j][3] - A[i][2] * A[j][0] - A[i][3] * A[j][1];
        const double omega = j == i + 2 ? 1.0 : i == j + 2 ? -1.0 : 0.0;
        worst = std::max(worst, std::fabs(form - omega));
      }
    }
    return worst;
  };
  const double own = off_symplectic(Kind::variational), euler = off_symplectic(Kind::euler);
  std::printf("off symplectic: variational %.1e, Euler %.1e\n", own, euler);
  EXPECT_LT(own, 1e-8);
  EXPECT_GT(euler, 1e-5);
}

TEST(Variational, SolvesItsEquationInFewRounds) {
  Random random(85);
  const Model model = lossless_tree(random, all_joints(FreeJoint{}));
  State s = random_state(random, model);
  IntegratorData data(model);
  int most = 0;
  for (int i = 0; i < 500; ++i) {
    const auto rounds = step_variational<double>(model, data, s.q, s.v, {.h = 1e-3});
    ASSERT_TRUE(rounds);
    most = std::max(most, *rounds);
  }
  std::printf("most rounds %d\n", most);
  EXPECT_LE(most, 6);
}

// Damping too stiff for the iteration is reported, not integrated wrongly.
TEST(Variational, SaysThatADamperIsTooStiffForTheStep) {
  ModelBuilder builder;
  must_build(builder.add(
      {.joint = RevoluteJoint{}, .inertia = Inertia(1.0, Vec3{1, 1, 1}), .damping = 5000.0}));
  const Model model = must_build(builder.build());
  IntegratorData data(model);
  Numbers q{0.0}, v{1.0};
  const auto done = step_variational<double>(model, data, q, v, {.h = 1e-3});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::not_converged);
  EXPECT_EQ(v, Numbers{1.0});
}

}  // namespace
}  // namespace vp::test
