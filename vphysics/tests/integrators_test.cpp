// Integration on the Lie group: orders of convergence on trees with every joint, closed-form
// motions, and rejected arguments.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "motions.h"

namespace vp::test {
namespace {

using Stepper = std::function<Expected<void>(const Model&, IntegratorData&, Numbers&, Numbers&,
                                             const StepT<double>&)>;

Expected<void> euler(const Model& model, IntegratorData& data, Numbers& q, Numbers& v,
                     const StepT<double>& step) {
  return step_semi_implicit<double>(model, data, q, v, step);
}
Expected<void> rk4(const Model& model, IntegratorData& data, Numbers& q, Numbers& v,
                   const StepT<double>& step) {
  return step_rk4<double>(model, data, q, v, step);
}
Expected<void> variational(const Model& model, IntegratorData& data, Numbers& q, Numbers& v,
                           const StepT<double>& step) {
  const auto rounds = step_variational<double>(model, data, q, v, step);
  if (!rounds) return tl::make_unexpected(rounds.error());
  return {};
}
// One step of the embedded pair, whatever its error.
Expected<void> pair_once(const Model& model, IntegratorData& data, Numbers& q, Numbers& v,
                         const StepT<double>& step) {
  AdaptiveReport report;
  const auto done = advance_adaptive<double>(
      model, data, q, v, step, {.absolute = 1e9, .relative = 1e9, .first_step = step.h}, report);
  EXPECT_EQ(report.taken, done ? 1 : 0);
  return done;
}
// Integrates as accurately as double precision allows.
AdaptiveReport exactly(const Model& model, Numbers& q, Numbers& v, const StepT<double>& step,
                       double tolerance = 1e-13) {
  IntegratorData data(model);
  AdaptiveReport report;
  const auto done = advance_adaptive<double>(
      model, data, q, v, step, {.absolute = tolerance, .relative = tolerance}, report);
  EXPECT_TRUE(done) << done.error().message;
  EXPECT_DOUBLE_EQ(report.t, step.t + step.h);
  return report;
}

void run(const Stepper& stepper, const Model& model, Numbers& q, Numbers& v, StepT<double> step,
         double duration, int steps) {
  IntegratorData data(model);
  const double begin = step.t;
  step.h = duration / steps;
  for (int i = 0; i < steps; ++i) {
    step.t = begin + i * step.h;
    const auto done = stepper(model, data, q, v, step);
    ASSERT_TRUE(done) << done.error().message;
  }
}

// Forces that depend on coordinates, velocities and time.
void some_forces(std::span<const double> q, std::span<const double> v, double t,
                 std::span<double> tau) {
  for (std::size_t i = 0; i < tau.size(); ++i) {
    tau[i] = 0.4 * std::sin(3 * t + static_cast<double>(i)) - 0.1 * v[i] - 0.3 * q[i];
  }
}

// --- order of convergence

struct Case {
  const char* name;
  Stepper stepper;
  int steps;  // of the coarse run; the fine run has twice as many
  double duration;
  double order;  // of the error at the end
};

// Every joint in one tree, with damping, armature, gravity, an external load and varying forces.
// The embedded pair takes steps of a fixed length.
TEST(Integrators, ConvergeWithTheirOrderOnTreesOfEveryJoint) {
  const Case cases[] = {{"semi-implicit Euler", euler, 1600, 0.4, 1},
                        {"Runge-Kutta-Munthe-Kaas 4", rk4, 80, 0.4, 4},
                        {"variational", variational, 400, 0.4, 2},
                        {"Dormand-Prince", pair_once, 20, 0.4, 5}};
  const auto forces = some_forces;
  Random random(71);
  for (int round = 0; round < 3; ++round) {
    // Ten joints, one of every kind including a user-defined one, and ten more.
    ModelBuilder builder;
    for (int i = 0; i < 20; ++i) {
      LinkSpec link{.parent = static_cast<int>(random.word() % static_cast<unsigned>(i + 1)) - 1,
                    .joint = random_joint(random, i % 10),
                    .T_parent_joint = random.pose(0.3),
                    .inertia = random_body(random)};
      link.armature = 0.05;
      link.damping = 0.1;
      must_build(builder.add(std::move(link)));
    }
    const Model model = must_build(builder.build());
    const State s = random_state(random, model);
    std::vector<dse3> external(20);
    for (dse3& F : external) F = {random.in_cube(1), random.in_cube(1)};
    const StepT<double> step{.t = 0.3, .forces = forces, .loads = {{0, 1, -5}, external}};
    for (const Case& c : cases) {
      Numbers q = s.q, v = s.v;
      StepT<double> whole = step;
      whole.h = c.duration;
      exactly(model, q, v, whole);
      double error[2];
      for (int finer = 0; finer < 2; ++finer) {
        Numbers a = s.q, b = s.v;
        run(c.stepper, model, a, b, step, c.duration, c.steps << finer);
        error[finer] = distance(model, q, v, a, b);
      }
      const double order = std::log2(error[0] / error[1]);
      std::printf("%s: order %.2f, errors %.1e %.1e\n", c.name, order, error[0], error[1]);
      EXPECT_NEAR(order, c.order, 0.13 * c.order) << c.name;
    }
  }
}

// The error follows the tolerance, and the step size its fifth root.
TEST(Adaptive, TakesStepsAsTheFifthRootOfTheTolerance) {
  Random random(72);
  const Model model = random_tree(random, 8, 9);
  const State s = random_state(random, model);
  Numbers q = s.q, v = s.v;
  exactly(model, q, v, {.h = 6.0});
  long before = 0;
  for (const double tolerance : {1e-7, 1e-12}) {
    Numbers a = s.q, b = s.v;
    const AdaptiveReport report = exactly(model, a, b, {.h = 6.0}, tolerance);
    const double error = distance(model, q, v, a, b);
    std::printf("tolerance %.0e: error %.1e, %ld steps, %ld refused, smallest %.1e\n", tolerance,
                error, report.taken, report.refused, report.smallest);
    EXPECT_LT(error, 300 * tolerance);
    EXPECT_LT(report.refused, report.taken / 4 + 3);
    if (before != 0) {
      EXPECT_NEAR(static_cast<double>(report.taken) / static_cast<double>(before), 10, 3);
    }
    before = report.taken;
  }
}

// --- closed forms

// Arithmetic-geometric mean.
double agm(double a, double b) {
  while (std::fabs(a - b) > 1e-15 * a) {
    const double g = std::sqrt(a * b);
    a = 0.5 * (a + b);
    b = g;
  }
  return a;
}
// Jacobi's sn, cn, dn by descending Landen transformations (Abramowitz, Stegun, 16.4).
struct Elliptic {
  double sn, cn, dn;
};
Elliptic elliptic(double u, double k) {
  double a[16], c[16], b = std::sqrt(1 - k * k);
  int n = 0;
  a[0] = 1, c[0] = k;
  while (std::fabs(c[n]) > 1e-16 && n < 15) {
    a[n + 1] = 0.5 * (a[n] + b);
    c[n + 1] = 0.5 * (a[n] - b);
    b = std::sqrt(a[n] * b);
    ++n;
  }
  double phi = std::ldexp(a[n] * u, n);
  for (; n > 0; --n) phi = 0.5 * (phi + std::asin(c[n] / a[n] * std::sin(phi)));
  const double sn = std::sin(phi);
  return {sn, std::cos(phi), std::sqrt(1 - k * k * sn * sn)};
}

struct Method {
  const char* name;
  Stepper stepper;
  double bound;  // with steps of 1 ms
};

// theta'' = -(m g l / I) sin theta from rest at theta0: the period is
//   2 pi / (omega agm(1, cos(theta0/2))).
// Measured: pair 3e-13, RK4 8e-13, variational 3e-6.
TEST(ClosedForm, PendulumIsBackAfterItsPeriod) {
  const double m = 1.3, l = 0.7, g = 9.81, I = m * l * l + 0.02, start = 2.8;
  const Model model = one_body(RevoluteJoint{{0, -1, 0}},
                               Inertia(m, Vec3{0, 0, -m * l}, Sym3{I, I, 0.02, 0, 0, 0}));
  const double omega = std::sqrt(m * g * l / I);
  const double period = 2 * kPi / (omega * agm(1, std::cos(0.5 * start)));
  Numbers q{start}, v{0.0};
  exactly(model, q, v, {.h = period});
  EXPECT_NEAR(q[0], start, 1e-11);
  EXPECT_NEAR(v[0], 0.0, 1e-11);
  for (const Method& method : {Method{"RK4", rk4, 1e-10}, {"variational", variational, 1e-4}}) {
    q = {start}, v = {0.0};
    run(method.stepper, model, q, v, {}, period, static_cast<int>(period / 1e-3));
    std::printf("%s: %.1e\n", method.name, std::max(std::fabs(q[0] - start), std::fabs(v[0])));
    EXPECT_NEAR(q[0], start, method.bound) << method.name;
    EXPECT_NEAR(v[0], 0.0, method.bound) << method.name;
  }
}

SE3 pose_at_end(const Model& model, const Numbers& q) {
  Data data(model);
  forward_kinematics<double>(model, data, q, {});
  return T_world_link<double>(model, data, 0);
}

// R(t) = Exp(t L / I1) R0 Exp(t (1 - I3 / I1) w3 z): it precesses about L and nutates about z.
TEST(ClosedForm, FreeSymmetricBodyPrecessesAndNutates) {
  const double I1 = 0.3, I3 = 0.5, t = 2.5;
  const Vec3 w{1.5, -0.7, 4.0};
  const Vec3 L{I1 * w.x, I1 * w.y, I3 * w.z};
  const SO3 R = Exp((t / I1) * L) * Exp(Vec3{0, 0, t * (1 - I3 / I1) * w.z});
  const Vec3 w_end = Inv(Exp(Vec3{0, 0, t * (1 - I3 / I1) * w.z})) * w;
  const Stepper exact = [](const Model& model, IntegratorData&, Numbers& q, Numbers& v,
                           const StepT<double>& step) {
    exactly(model, q, v, step);
    return Expected<void>{};
  };
  // With a free joint, the body also translates while it rotates.
  for (const bool free : {false, true}) {
    const Joint joint = free ? Joint(FreeJoint{}) : Joint(BallJoint{});
    const Model model = one_body(joint, Inertia(2.0, Vec3{I1, I1, I3}));
    for (const Method& method :
         {Method{"pair", exact, 3e-12}, {"RK4", rk4, 3e-9}, {"variational", variational, 1e-4}}) {
      Numbers q = model.zero_coordinates(), v{w.x, w.y, w.z};
      const Vec3 flight{0.3, -1.0, 0.2};
      if (free) v.insert(v.end(), {flight.x, flight.y, flight.z});
      const int steps = method.bound < 1e-11 ? 1 : 2500;
      run(method.stepper, model, q, v, {.loads = {.gravity = {}}}, t, steps);
      const SE3 end = pose_at_end(model, q);
      const double off =
          norm(Log(Inv(R) * SO3(end.rotation()))) + norm(Vec3{v[0], v[1], v[2]} - w_end);
      std::printf("%s: %.1e\n", method.name, off);
      EXPECT_LT(off, method.bound) << method.name;
      if (free) {
        EXPECT_LT(norm(end.position() - t * flight), method.bound) << method.name;
      }
    }
  }
}

// Steady precession at a tilt: I3 w3 phi' - I1 phi'^2 cos(tilt) = m g l.
TEST(ClosedForm, HeavyTopPrecessesSteadily) {
  const double m = 0.8, l = 0.4, g = 9.81, I1 = 0.2, I3 = 0.05, tilt = 0.6, rate = 2.0, t = 3.0;
  const double w3 = (m * g * l + I1 * rate * rate * std::cos(tilt)) / (I3 * rate);
  const Model model =
      one_body(BallJoint{}, Inertia(m, Vec3{0, 0, m * l}, Sym3{I1, I1, I3, 0, 0, 0}));
  const Quaternion turn = to_quaternion(Exp(Vec3{tilt, 0, 0}));
  const Numbers q0{turn.x, turn.y, turn.z, turn.w}, v0{0, rate * std::sin(tilt), w3};
  const Vec3 axis = Exp(Vec3{0, 0, rate * t}) * (Exp(Vec3{tilt, 0, 0}) * Vec3{0, 0, 1});
  Numbers q = q0, v = v0;
  exactly(model, q, v, {.h = t});
  EXPECT_LT(norm(pose_at_end(model, q).rotation().cz - axis), 1e-11);
  EXPECT_NEAR(v[2], w3, 1e-12);
  for (const Method& method : {Method{"RK4", rk4, 1e-6}, {"variational", variational, 2e-3}}) {
    q = q0, v = v0;
    run(method.stepper, model, q, v, {}, t, 3000);
    const double off = norm(pose_at_end(model, q).rotation().cz - axis);
    std::printf("%s: %.1e\n", method.name, off);
    EXPECT_LT(off, method.bound) << method.name;
    EXPECT_NEAR(v[2], w3, method.bound);
  }
}

// Euler's equations for I1 < I2 < I3 and L^2 > 2 E I2 (Landau, Lifshitz, Mechanics, section 37):
//   w1 = a1 cn u, w2 = a2 sn u, w3 = a3 dn u, u = t sqrt((I3 - I2)(L^2 - 2 E I1) / (I1 I2 I3))
// Started almost about the intermediate axis, the body flips after every half period 2 K.
TEST(ClosedForm, AsymmetricBodyFlipsAsJacobiSays) {
  const double I[3] = {0.2, 0.35, 0.5};
  const Model model = one_body(FreeJoint{}, Inertia(1.0, Vec3{I[0], I[1], I[2]}));
  const Vec3 w{0.0, 3.0, 0.01};  // where cn is 0
  const double E2 = I[1] * w.y * w.y + I[2] * w.z * w.z;
  const double L2 = I[1] * I[1] * w.y * w.y + I[2] * I[2] * w.z * w.z;
  const double rate = std::sqrt((I[2] - I[1]) * (L2 - E2 * I[0]) / (I[0] * I[1] * I[2]));
  const double k = std::sqrt((I[1] - I[0]) * (E2 * I[2] - L2) / ((I[2] - I[1]) * (L2 - E2 * I[0])));
  const double K = 0.5 * kPi / agm(1, std::sqrt(1 - k * k));
  const double a1 = std::sqrt((E2 * I[2] - L2) / (I[0] * (I[2] - I[0])));
  const double a2 = std::sqrt((E2 * I[2] - L2) / (I[1] * (I[2] - I[1])));
  const double a3 = std::sqrt((L2 - E2 * I[0]) / (I[2] * (I[2] - I[0])));
  std::printf("flips every %.4f s\n", 2 * K / rate);
  Numbers q = model.zero_coordinates(), v{w.x, w.y, w.z, 0, 0, 0};
  const double part = 0.5 * K / rate;
  double worst = 0.0;
  for (int i = 1; i <= 16; ++i) {  // two periods
    exactly(model, q, v, {.h = part, .loads = {.gravity = {}}});
    const Elliptic e = elliptic(K + i * 0.5 * K, k);
    worst = std::max(worst, norm(Vec3{v[0], v[1], v[2]} - Vec3{a1 * e.cn, a2 * e.sn, a3 * e.dn}));
    if (i % 8 == 4) {
      EXPECT_NEAR(v[1], -3.0, 1e-8);  // flipped
    }
  }
  std::printf("worst %.1e\n", worst);
  EXPECT_LT(worst, 1e-8);  // instability multiplies rounding errors by 300 a flip
}

// --- the same code for every scalar

template <class T, int N>
void lanes_agree(double bound) {
  using P = PackT<T, N>;
  Random random(73);
  const Model model = random_tree(random, 12);
  const ModelT<T> narrow(model);
  for (const bool fourth : {false, true}) {
    IntegratorDataT<P> data(narrow);
    std::vector<P> q(static_cast<std::size_t>(model.coordinates())),
        v(static_cast<std::size_t>(model.velocities())), tau(v.size());
    std::vector<State> states;
    for (int lane = 0; lane < N; ++lane) {
      states.push_back(random_state(random, model));
      const State& s = states.back();
      for (std::size_t i = 0; i < q.size(); ++i) q[i].set(lane, static_cast<T>(s.q[i]));
      for (std::size_t i = 0; i < v.size(); ++i) {
        v[i].set(lane, static_cast<T>(s.v[i]));
        tau[i].set(lane, static_cast<T>(s.tau[i]));
      }
    }
    const StepT<P> step{.h = T(0.01), .forces = tau};
    for (int i = 0; i < 10; ++i) {
      const auto done = fourth ? step_rk4<P>(narrow, data, q, v, step)
                               : step_semi_implicit<P>(narrow, data, q, v, step);
      ASSERT_TRUE(done);
    }
    for (int lane = 0; lane < N; ++lane) {
      State& s = states[static_cast<std::size_t>(lane)];
      run(fourth ? Stepper(rk4) : Stepper(euler), model, s.q, s.v, {.forces = s.tau}, 0.1, 10);
      for (std::size_t i = 0; i < q.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(q[i][lane]), s.q[i], bound) << fourth;
      }
    }
  }
}

TEST(Integrators, GiveInEachLaneWhatOneStateGives) {
  lanes_agree<double, 4>(1e-11);
#ifndef VP_FEW_SCALARS
  lanes_agree<double, 8>(1e-11);
  lanes_agree<float, 8>(1e-3);
#endif
}

TEST(Integrators, WorkInFloat) {
  Random random(74);
  const Model model = random_tree(random, 10);
  const ModelT<float> narrow(model);
  const State s = random_state(random, model);
  Numbers q = s.q, v = s.v;
  exactly(model, q, v, {.h = 0.2});
  const std::vector<float> q0(s.q.begin(), s.q.end()), v0(s.v.begin(), s.v.end());
  IntegratorDataT<float> data(narrow);
  for (const int which : {0, 1}) {
    std::vector<float> a = q0, b = v0;
    if (which == 0) {
      AdaptiveReportT<float> report;
      ASSERT_TRUE(advance_adaptive<float>(narrow, data, a, b, {.h = 0.2f},
                                          {.absolute = 1e-5f, .relative = 1e-5f}, report));
    } else {
      for (int i = 0; i < 200; ++i) {
        ASSERT_TRUE(step_variational<float>(narrow, data, a, b, {.h = 1e-3f}));
      }
    }
    EXPECT_LT(distance(model, q, v, Numbers(a.begin(), a.end()), Numbers(b.begin(), b.end())),
              2e-3);
  }
}

TEST(Integrators, KeepQuaternionsOfUnitLength) {
  Random random(75);
  ModelBuilder builder;
  must_build(builder.add({"free", kWorld, FreeJoint{}, {}, random_body(random)}));
  must_build(builder.add({"ball", 0, BallJoint{}, random.pose(0.3), random_body(random)}));
  const Model model = must_build(builder.build());
  for (const Stepper& stepper : {Stepper(euler), Stepper(rk4), Stepper(variational)}) {
    State s = random_state(random, model);
    for (double& x : s.v) x *= 5;
    run(stepper, model, s.q, s.v, {}, 5.0, 5000);
    for (const std::size_t at : {std::size_t{3}, std::size_t{7}}) {
      double square = 0;
      for (std::size_t k = at; k < at + 4; ++k) square += s.q[k] * s.q[k];
      EXPECT_NEAR(square, 1.0, 1e-15);
    }
  }
}

// --- rejected arguments

TEST(Integrators, RefuseStepsThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Model model = one_body(RevoluteJoint{}, Inertia(1.0, Vec3{1, 1, 1}));
  IntegratorData data(model);
  const Numbers q0{0.1}, v0{0.2};
  Numbers q = q0, v = v0;
  for (const Stepper& stepper :
       {Stepper(euler), Stepper(rk4), Stepper(variational), Stepper(pair_once)}) {
    for (const StepT<double>& step :
         {StepT<double>{}, {.h = -1e-3}, {.h = nan}, {.h = infinity}, {.h = 1e-3, .t = nan}}) {
      const auto done = stepper(model, data, q, v, step);
      ASSERT_FALSE(done);
      EXPECT_EQ(done.error().code, Errc::invalid_argument);
      EXPECT_NE(done.error().message, "");
    }
    const Numbers two(2);
    EXPECT_FALSE(stepper(model, data, q, v, {.h = 1e-3, .forces = two}));
  }
  AdaptiveReport report;
  for (const Adaptive& options :
       {Adaptive{.absolute = 0.0}, Adaptive{.relative = -1.0}, Adaptive{.absolute = nan},
        Adaptive{.first_step = -1.0}, Adaptive{.minimum_step = nan}, Adaptive{.max_steps = 0}}) {
    const auto done = advance_adaptive<double>(model, data, q, v, {.h = 1.0}, options, report);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Errc::invalid_argument);
  }
  for (const Variational& options : {Variational{.tolerance = 0.0}, Variational{.tolerance = nan},
                                     Variational{.max_iterations = 0}}) {
    const auto done = step_variational<double>(model, data, q, v, {.h = 1e-3}, options);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Errc::invalid_argument);
  }
  EXPECT_EQ(q, q0);
  EXPECT_EQ(v, v0);
}

TEST(Integrators, PassOnThatAJointMovesNoInertiaAndLeaveTheState) {
  const Model model = one_body(RevoluteJoint{}, Inertia(1.0, Vec3{1, 1, 0}));
  IntegratorData data(model);
  Numbers q{0.5}, v{1.0};
  for (const Stepper& stepper : {Stepper(euler), Stepper(rk4), Stepper(variational)}) {
    const auto done = stepper(model, data, q, v, {.h = 1e-3});
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Errc::singular);
  }
  AdaptiveReport report;
  const auto done = advance_adaptive<double>(model, data, q, v, {.h = 1.0}, {}, report);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::singular);
  EXPECT_EQ(q, Numbers{0.5});
  EXPECT_EQ(v, Numbers{1.0});
}

// A force that diverges towards t = 1 cannot be integrated past it.
TEST(Adaptive, SaysWhereItsStepFallsBelowTheMinimum) {
  const Model model = one_body(RevoluteJoint{}, Inertia(1.0, Vec3{1, 1, 1}));
  IntegratorData data(model);
  Numbers q{0.0}, v{0.0};
  const auto pole = [](std::span<const double>, std::span<const double>, double t,
                       std::span<double> tau) { tau[0] = 1 / ((1 - t) * (1 - t)); };
  AdaptiveReport report;
  const auto done = advance_adaptive<double>(model, data, q, v, {.h = 2.0, .forces = pole},
                                             {.minimum_step = 1e-6}, report);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::not_converged);
  EXPECT_NEAR(report.t, 1.0, 1e-3);
  EXPECT_GT(report.refused, 0);
  EXPECT_NEAR(v[0], 1 / (1 - report.t) - 1, 1e-5 * v[0]);  // the state is the one at report.t
  q = {0.0}, v = {0.0};
  const auto few = advance_adaptive<double>(model, data, q, v, {.h = 2.0, .forces = pole},
                                            {.max_steps = 5}, report);
  ASSERT_FALSE(few);
  EXPECT_EQ(report.taken + report.refused, 5);
}

TEST(Integrators, SayThatAStepIsTooLongForATurn) {
  const Model model = one_body(BallJoint{}, Inertia(1.0, Vec3{1, 1, 1}));
  IntegratorData data(model);
  Numbers q{0, 0, 0, 1}, v{0, 0, 100};
  const auto whole = step_rk4<double>(model, data, q, v, {.h = 0.1});
  ASSERT_FALSE(whole);
  EXPECT_EQ(whole.error().code, Errc::invalid_argument);
  const auto half = step_variational<double>(model, data, q, v, {.h = 0.05});
  ASSERT_FALSE(half);
  EXPECT_EQ(half.error().code, Errc::not_converged);
  EXPECT_EQ(v, (Numbers{0, 0, 100}));
}

}  // namespace
}  // namespace vp::test
