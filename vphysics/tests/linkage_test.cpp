// Closed mechanisms against closed forms from textbooks: the planar four-bar linkage and the
// Stewart platform.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "trees.h"
#include "vphysics/lie/dual.h"
#include "vphysics/multibody/configuration.h"
#include "vphysics/multibody/constrained_dynamics.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;
using Dual = DualT<double>;

ConstrainedData closed_model(const Model& model, std::vector<ConstraintPtr> constraints) {
  return {model, must_build(ConstraintSet::make(model, std::move(constraints)))};
}

// --- the four-bar linkage: crank a, coupler b, rocker c, ground d from (0, 0) to (d, 0)

struct FourBar {
  double a, b, c, d;
  double mass[3] = {0.7, 1.1, 0.9};    // crank, coupler, rocker
  double place[3] = {0.4, 0.6, 0.45};  // of their centres, as fractions of their lengths
  double about_centre[3] = {0.01, 0.03, 0.02};
  SE3 T_world_plane{};
};

// In the xy plane. The crank's and the rocker's angles are from the ground, the coupler's is from
// the crank.
Model four_bar_model(const FourBar& f) {
  ModelBuilder builder;
  const double lengths[3] = {f.a, f.b, f.c};
  const auto body = [&](std::size_t i) {
    return Inertia(f.mass[i], Vec3{1e-3, f.about_centre[i], f.about_centre[i]})
        .InvXform(SE3(Vec3{f.place[i] * lengths[i], 0, 0}));
  };
  const SE3 far = f.T_world_plane * SE3(Vec3{f.d, 0, 0});
  must_build(builder.add({"crank", kWorld, RevoluteJoint{}, f.T_world_plane, body(0)}));
  must_build(builder.add({"coupler", 0, RevoluteJoint{}, SE3(Vec3{f.a, 0, 0}), body(1)}));
  must_build(builder.add({"rocker", kWorld, RevoluteJoint{}, far, body(2)}));
  return must_build(builder.build());
}
// Iyy = Izz above is that of a thin bar. Principal moments that no flat bar has would be rejected.

std::vector<ConstraintPtr> four_bar_loop(const FourBar& f) {
  return {close_hinge({1, SE3(Vec3{f.b, 0, 0})}, {2, SE3(Vec3{f.c, 0, 0})})};
}

// Freudenstein's equation: K1 cos(t4) - K2 cos(t2) + K3 = cos(t2 - t4), solved with the half-angle
// substitution for the open circuit.
struct Angles {
  double crank, coupler, rocker;  // from the ground
};
Angles freudenstein(const FourBar& f, double t2) {
  const double K1 = f.d / f.a, K2 = f.d / f.c;
  const double K3 = (f.a * f.a - f.b * f.b + f.c * f.c + f.d * f.d) / (2 * f.a * f.c);
  const double A = std::cos(t2) - K1 - K2 * std::cos(t2) + K3;
  const double B = -2 * std::sin(t2), C = K1 - (K2 + 1) * std::cos(t2) + K3;
  const double t4 = 2 * std::atan2(-B - std::sqrt(B * B - 4 * A * C), 2 * A);
  const double x = f.d + f.c * std::cos(t4) - f.a * std::cos(t2);
  const double y = f.c * std::sin(t4) - f.a * std::sin(t2);
  return {t2, std::atan2(y, x), t4};
}
double turned_to(double angle) {
  return std::remainder(angle, 2 * kPi);
}

const FourBar kCrankRocker{0.3, 0.9, 0.7, 0.8};

TEST(FourBar, StandsWhereFreudensteinSays) {
  Random random(91);
  const struct {
    SE3 plane;
    double bound;
  } cases[] = {
      {SE3{}, 2e-12},
      {random.pose(3), 2e-12},
      {SE3(random.rotation(), {1e6, -1e6, 1e6}), 1e-9}};  // where doubles have a spacing of 1e-10
  for (const auto& [plane, bound] : cases) {
    FourBar f = kCrankRocker;
    f.T_world_plane = plane;
    const Model model = four_bar_model(f);
    ConstrainedData data = closed_model(model, four_bar_loop(f));
    const int held[] = {0};
    for (double t2 = 0.0; t2 < 2 * kPi; t2 += 0.1) {
      const Angles expected = freudenstein(f, t2);
      Numbers q = {t2, turned_to(expected.coupler - t2) + 0.3, expected.rocker - 0.2};
      const auto steps = close_loops(model, data, q, {.held = held});
      ASSERT_TRUE(steps) << steps.error().message;
      EXPECT_LE(*steps, 6);  // of Newton's method
      EXPECT_EQ(q[0], t2);
      EXPECT_NEAR(turned_to(q[1] - (expected.coupler - t2)), 0.0, bound);
      EXPECT_NEAR(turned_to(q[2] - expected.rocker), 0.0, bound);
    }
  }
}

TEST(FourBar, MovesAsTheVelocityLoopSays) {
  const FourBar& f = kCrankRocker;
  const Model model = four_bar_model(f);
  ConstrainedData data = closed_model(model, four_bar_loop(f));
  for (double t2 = 0.05; t2 < 2 * kPi; t2 += 0.1) {
    const Angles at = freudenstein(f, t2);
    const Numbers q = {t2, at.coupler - t2, at.rocker};
    Numbers v = {2.0, -1.0, 0.7};
    ASSERT_TRUE(project_velocities(model, data, q, v));
    const double w2 = v[0], w3 = v[0] + v[1], w4 = v[2];
    EXPECT_GT(std::fabs(w2), 1e-3);
    EXPECT_NEAR(w3, f.a * w2 / f.b * std::sin(at.rocker - t2) / std::sin(at.coupler - at.rocker),
                1e-11);
    EXPECT_NEAR(w4, f.a * w2 / f.c * std::sin(t2 - at.coupler) / std::sin(at.rocker - at.coupler),
                1e-11);
    EXPECT_EQ(data.rank(), 2);  // independent rows, of the hinge's five
  }
}

// The linkage as a system with one degree of freedom: T = I(t) t'^2 / 2, U(t), from the closed-form
// rates of coupler and rocker. Dual numbers give I' and U'.
//   I t'' + I' t'^2 / 2 + U' = tau
struct OneDegree {
  Dual I, U;
};
OneDegree lagrange(const FourBar& f, double angle, double gravity) {
  const auto root = [](const Dual& x) {
    Dual out(std::sqrt(x.value));
    out.derivative[0] = x.derivative[0] / (2 * out.value);
    return out;
  };
  Dual c2(std::cos(angle)), s2(std::sin(angle));
  c2.derivative[0] = -s2.value;
  s2.derivative[0] = c2.value;
  // The far end of the coupler: the upper intersection of circles about A and the ground's end.
  const Dual ax = Dual(f.a) * c2, ay = Dual(f.a) * s2;
  const Dual dx = Dual(f.d) - ax, dy = -ay, D2 = dx * dx + dy * dy;
  const Dual along = (D2 + Dual(f.b * f.b - f.c * f.c)) / (Dual(2.0) * D2);
  const Dual across = root(Dual(f.b * f.b) / D2 - along * along);
  const Dual c3 = (along * dx - across * dy) / Dual(f.b);
  const Dual s3 = (along * dy + across * dx) / Dual(f.b);
  const Dual c4 = (ax + Dual(f.b) * c3 - Dual(f.d)) / Dual(f.c);
  const Dual s4 = (ay + Dual(f.b) * s3) / Dual(f.c);
  // a (-s2, c2) + b k3 (-s3, c3) = c k4 (-s4, c4)
  const Dual det = s3 * c4 - c3 * s4;  // sin(t3 - t4)
  const Dual k3 = Dual(f.a / f.b) * (s4 * c2 - c4 * s2) / det;
  const Dual k4 = Dual(f.a / f.c) * (s3 * c2 - c3 * s2) / det;
  const Dual r2(f.place[0] * f.a), r3(f.place[1] * f.b), r4(f.place[2] * f.c);
  const Dual vx = -ay - r3 * k3 * s3, vy = ax + r3 * k3 * c3;
  OneDegree out;
  out.I = Dual(f.mass[0]) * r2 * r2 + Dual(f.about_centre[0]) +
          Dual(f.mass[1]) * (vx * vx + vy * vy) + Dual(f.about_centre[1]) * k3 * k3 +
          (Dual(f.mass[2]) * r4 * r4 + Dual(f.about_centre[2])) * k4 * k4;
  out.U = Dual(gravity) * (Dual(f.mass[0]) * r2 * s2 + Dual(f.mass[1]) * (ay + r3 * s3) +
                           Dual(f.mass[2]) * r4 * s4);
  return out;
}

TEST(FourBar, AcceleratesAsItsLagrangeEquationSays) {
  const FourBar& f = kCrankRocker;
  const Model model = four_bar_model(f);
  ConstrainedData data = closed_model(model, four_bar_loop(f));
  const double g = 9.81;
  Random random(92);
  double worst = 0.0;
  for (double t2 = 0.05; t2 < 2 * kPi; t2 += 0.05) {
    const Angles at = freudenstein(f, t2);
    const double rate = random.uniform(-5, 5), torque = random.uniform(-10, 10);
    const double k3 = f.a / f.b * std::sin(at.rocker - t2) / std::sin(at.coupler - at.rocker);
    const double k4 = f.a / f.c * std::sin(t2 - at.coupler) / std::sin(at.rocker - at.coupler);
    const Numbers q = {t2, at.coupler - t2, at.rocker};
    const Numbers v = {rate, (k3 - 1) * rate, k4 * rate}, tau = {torque, 0, 0};
    Numbers a(3);
    const auto done =
        constrained_forward_dynamics(model, data, q, v, tau, {.gravity = {0, -g, 0}}, 0.0, a);
    ASSERT_TRUE(done) << done.error().message;
    const OneDegree e = lagrange(f, t2, g);
    const double expected =
        (torque - 0.5 * e.I.derivative[0] * rate * rate - e.U.derivative[0]) / e.I.value;
    worst = std::max(worst, std::fabs(a[0] - expected) / (1 + std::fabs(expected)));
  }
  std::printf("worst: %.1e\n", worst);
  EXPECT_LT(worst, 1e-11);
}

// Fourth-order Runge-Kutta, with a projection onto the constraints after each step.
void rk4_step(const Model& model, ConstrainedData& data, const Loads& loads, double h, Numbers& q,
              Numbers& v) {
  const std::size_t n = v.size();
  const Numbers tau(n);
  std::array<Numbers, 4> dq, dv;
  const double share[4] = {0.0, 0.5, 0.5, 1.0};
  for (std::size_t s = 0; s < 4; ++s) {
    Numbers p = q, w = v;
    for (std::size_t i = 0; i < n && s > 0; ++i) {
      p[i] += share[s] * h * dq[s - 1][i];
      w[i] += share[s] * h * dv[s - 1][i];
    }
    dq[s] = w;
    dv[s].resize(n);
    const auto done = constrained_forward_dynamics(model, data, p, w, tau, loads, 0.0, dv[s]);
    ASSERT_TRUE(done) << done.error().message;
  }
  for (std::size_t i = 0; i < n; ++i) {
    q[i] += h / 6 * (dq[0][i] + 2 * dq[1][i] + 2 * dq[2][i] + dq[3][i]);
    v[i] += h / 6 * (dv[0][i] + 2 * dv[1][i] + 2 * dv[2][i] + dv[3][i]);
  }
  ASSERT_TRUE(close_loops(model, data, q));
  ASSERT_TRUE(project_velocities(model, data, q, v));
}

struct Course {
  double drift = 0.0, open = 0.0, turned = 0.0;
};
// Under gravity from 1 rad. The energy is that of the closed form.
Course course(int steps, double h) {
  const FourBar& f = kCrankRocker;
  const Model model = four_bar_model(f);
  ConstrainedData data = closed_model(model, four_bar_loop(f));
  const double g = 9.81;
  const Angles start = freudenstein(f, 1.0);
  Numbers q = {1.0, start.coupler - 1.0, start.rocker}, v = {4.0, 0.0, 0.0};
  const auto energy = [&] {
    const OneDegree e = lagrange(f, q[0], g);
    return 0.5 * e.I.value * v[0] * v[0] + e.U.value;
  };
  EXPECT_TRUE(project_velocities(model, data, q, v));
  const double before = energy();
  Course out;
  for (int i = 0; i < steps; ++i) {
    const double was = q[0];
    rk4_step(model, data, {.gravity = {0, -g, 0}}, h, q, v);
    if (testing::Test::HasFatalFailure()) break;
    out.turned += std::fabs(q[0] - was);
    out.drift = std::max(out.drift, std::fabs(energy() - before));
    evaluate_constraints(model, data, q, v);
    for (const double x : data.residual()) out.open = std::max(out.open, std::fabs(x));
  }
  std::printf("energy %.1e of %.3f J, residual %.1e, %.0f rad\n", out.drift, before, out.open,
              out.turned);
  return out;
}

// The integrator's energy error is of fourth order; the constraints add nothing to it.
TEST(FourBar, KeepsItsEnergyAndStaysClosed) {
  const Course fine = course(10000, 5e-4), coarse = course(5000, 1e-3);
  EXPECT_GT(fine.turned, 20.0);
  EXPECT_LT(fine.drift, 2e-6);
  EXPECT_GT(coarse.drift / fine.drift, 12.0);
  EXPECT_LT(fine.open, 1e-12);
}

// Without projection, Baumgarte stabilisation alone keeps the loop closed.
TEST(FourBar, BaumgartesRateClosesALoopInMotion) {
  const FourBar& f = kCrankRocker;
  const Model model = four_bar_model(f);
  ConstrainedData data = closed_model(model, four_bar_loop(f));
  const Angles start = freudenstein(f, 1.0);
  Numbers q = {1.0, start.coupler - 1.0 + 0.01, start.rocker}, v = {3.0, 0.0, 0.0}, a(3);
  const Numbers tau(3);
  double first = 0.0, open = 0.0;
  for (int i = 0; i < 5000; ++i) {
    ASSERT_TRUE(constrained_forward_dynamics(model, data, q, v, tau, {}, 20.0, a));
    open = 0.0;
    for (const double x : data.residual()) open = std::max(open, std::fabs(x));
    if (i == 0) first = open;
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] += 2e-4 * a[k];
      q[k] += 2e-4 * v[k];
    }
  }
  EXPECT_GT(first, 5e-3);
  EXPECT_LT(open, 0.05 * first);
}

// A parallelogram keeps its coupler parallel to the ground.
TEST(FourBar, OfAParallelogramKeepsTheCouplerParallel) {
  const FourBar f{0.4, 1.0, 0.4, 1.0};
  const Model model = four_bar_model(f);
  ConstrainedData data = closed_model(model, four_bar_loop(f));
  const int held[] = {0};
  for (double t2 = 0.2; t2 < 3.0; t2 += 0.1) {
    Numbers q = {t2, -t2 + 0.1, t2 + 0.1}, v = {1.0, 0.0, 0.0}, a(3);
    ASSERT_TRUE(close_loops(model, data, q, {.held = held}));
    EXPECT_NEAR(q[1], -t2, 1e-11);
    EXPECT_NEAR(q[2], t2, 1e-11);
    ASSERT_TRUE(project_velocities(model, data, q, v));
    EXPECT_NEAR(v[1], -v[0], 1e-9);
    EXPECT_NEAR(v[2], v[0], 1e-9);
    // The coupler only translates: I is constant, and its weight acts at the crank's end.
    ASSERT_TRUE(constrained_forward_dynamics(model, data, q, v, Numbers(3),
                                             {.gravity = {0, -9.81, 0}}, 0.0, a));
    const double r2 = f.place[0] * f.a, r4 = f.place[2] * f.c;
    const double I = f.mass[0] * r2 * r2 + f.about_centre[0] + f.mass[1] * f.a * f.a +
                     f.mass[2] * r4 * r4 + f.about_centre[2];
    const double torque =
        -9.81 * std::cos(t2) * (f.mass[0] * r2 + f.mass[1] * f.a + f.mass[2] * r4);
    EXPECT_NEAR(a[0], torque / I, 1e-8);  // near the folding position J is ill-conditioned
  }
  // Where all bars are collinear, the linkage could fold either way: J loses a row of rank.
  const Numbers flat = {0.0, 0.0, 0.0};
  Numbers v = {1.0, 0.3, -0.2};
  ASSERT_TRUE(project_velocities(model, data, flat, v));
  EXPECT_EQ(data.rank(), 1);
  for (const double x : v) EXPECT_TRUE(std::isfinite(x));
}

// --- the Stewart platform: six legs, each with a universal joint at the base, a slider, and a ball
// joint at the platform

struct Stewart {
  std::array<Vec3, 6> base, top;
  Inertia platform;
  double leg_mass;
};
Stewart stewart(double leg_mass) {
  Stewart s;
  for (std::size_t i = 0; i < 6; ++i) {
    const double k = static_cast<double>(i / 2) * 2 * kPi / 3, side = i % 2 ? 1.0 : -1.0;
    s.base[i] = {std::cos(k + side * 0.25), std::sin(k + side * 0.25), 0.0};
    s.top[i] = {0.6 * std::cos(k + side * 0.85), 0.6 * std::sin(k + side * 0.85), -0.05};
  }
  s.platform = Inertia(5.0, Vec3{0.4, 0.5, 0.8}).Xform(SE3(Vec3{0.02, -0.03, 0.01}));
  s.leg_mass = leg_mass;
  return s;
}
constexpr std::size_t kSlide[6] = {8, 11, 14, 17, 20, 23};  // indices of velocities
constexpr std::size_t kSlideQ[6] = {9, 12, 15, 18, 21, 24};

// A leg's body slides along its z axis. The slider's coordinate is the distance between the leg's
// ends.
Model stewart_model(const Stewart& s) {
  ModelBuilder builder;
  must_build(builder.add({"platform", kWorld, FreeJoint{}, SE3(Vec3{0, 0, 1}), s.platform}));
  const Inertia half(s.leg_mass, 0.01 * s.leg_mass * Vec3{1, 1, 1});
  for (std::size_t i = 0; i < 6; ++i) {
    const int before = static_cast<int>(1 + 2 * i);
    must_build(builder.add({"lower", kWorld, UniversalJoint{}, SE3(s.base[i]), half}));
    must_build(builder.add({"upper", before, PrismaticJoint{}, {}, half}));
  }
  return must_build(builder.build());
}
std::vector<ConstraintPtr> stewart_loops(const Stewart& s) {
  std::vector<ConstraintPtr> out;
  for (std::size_t i = 0; i < 6; ++i) {
    out.push_back(close_ball({static_cast<int>(2 + 2 * i), {}}, {0, SE3(s.top[i])}));
  }
  return out;
}
// Initial coordinates with the platform at X (world frame) and the legs roughly upright.
Numbers near_stewart(const SE3& X) {
  Numbers q(25);
  const Quaternion turn = to_quaternion(X.rotation());
  const Vec3 p = X.position() - Vec3{0, 0, 1};
  const double platform[] = {p.x, p.y, p.z, turn.x, turn.y, turn.z, turn.w};
  std::copy(platform, platform + 7, q.begin());
  for (const std::size_t i : kSlideQ) q[i] = 0.9;
  return q;
}

constexpr int kPlatformHeld[] = {0, 1, 2, 3, 4, 5};

TEST(Stewart, HasTheLegsThatInverseKinematicsGives) {
  const Stewart s = stewart(0.1);
  const Model model = stewart_model(s);
  ConstrainedData data = closed_model(model, stewart_loops(s));
  Random random(93);
  for (int round = 0; round < 50; ++round) {
    const SE3 X(Exp(0.3 * random.direction()).matrix(), Vec3{0, 0, 1} + random.in_cube(0.2));
    Numbers q = near_stewart(X);
    const auto steps = close_loops(model, data, q, {.held = kPlatformHeld});
    ASSERT_TRUE(steps) << steps.error().message;
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(q[kSlideQ[i]], norm(X * s.top[i] - s.base[i]), 3e-12);
    }
    // The inverse: with these leg lengths fixed, the platform returns to its pose from a displaced
    // start.
    Numbers p = q;
    p[0] += 0.05;
    p[2] -= 0.03;
    const int legs[] = {8, 11, 14, 17, 20, 23};
    ASSERT_TRUE(close_loops(model, data, p, {.held = legs}));
    evaluate_constraints(model, data, p, Numbers(24));
    const SE3 Y = T_world_link<double>(model, data.links(), 0);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(norm(Y * s.top[i] - s.base[i]), q[kSlideQ[i]], 3e-12);
    }
    EXPECT_LT(norm(Y.position() - X.position()), 1e-10);
  }
}

// With nearly massless legs, the slider forces act on the platform along the legs:
//   J V' - dad_V (J V) = sum of (p x f, f) + weight
// The error of the legs' mass is proportional to it.
TEST(Stewart, AcceleratesAsNewtonAndEulerSay) {
  Random random(94);
  const SE3 X(Exp(Vec3{0.1, -0.2, 0.3}).matrix(), {0.05, -0.08, 1.1});
  const se3 V{random.in_cube(1), random.in_cube(1)};
  Numbers forces(24);
  for (const std::size_t i : kSlide) forces[i] = random.uniform(0, 30);
  double off[2];
  const double leg_mass[2] = {1e-4, 1e-5};
  for (std::size_t k = 0; k < 2; ++k) {
    const Stewart s = stewart(leg_mass[k]);
    const Model model = stewart_model(s);
    ConstrainedData data = closed_model(model, stewart_loops(s));
    Numbers q = near_stewart(X), v(24), a(24);
    ASSERT_TRUE(close_loops(model, data, q, {.held = kPlatformHeld}));
    // The slider rates come from the leg lengths, the legs' rotations from the projection. The
    // platform is heavy, so the projection hardly changes its motion.
    const double parts[] = {V.w.x, V.w.y, V.w.z, V.v.x, V.v.y, V.v.z};
    std::copy(parts, parts + 6, v.begin());
    ASSERT_TRUE(project_velocities(model, data, q, v));
    const se3 W{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
    ASSERT_TRUE(constrained_forward_dynamics(model, data, q, v, forces, {}, 0.0, a));
    EXPECT_EQ(data.rank(), 18);

    const Vec3 weight = X.unrotate(Vec3{0, 0, -9.81 * s.platform.mass()});
    const Vec3 h = s.platform.first_moment();
    dse3 F{(1 / s.platform.mass()) * cross(h, weight), weight};
    for (std::size_t i = 0; i < 6; ++i) {
      const Vec3 leg = X * s.top[i] - s.base[i];
      const Vec3 f = X.unrotate((forces[kSlide[i]] / norm(leg)) * leg);
      F = F + dse3{cross(s.top[i], f), f};
      const Vec3 end = X.rotate(W.v + cross(W.w, s.top[i]));
      EXPECT_NEAR(v[kSlide[i]], dot(leg, end) / norm(leg), 1e-10);
    }
    const se3 A{{a[0], a[1], a[2]}, {a[3], a[4], a[5]}};
    const dse3 G = s.platform * A - dad(W, s.platform * W);
    off[k] = norm(G.m - F.m) + norm(G.f - F.f);
  }
  std::printf("off by %.1e N with legs of 0.1 g, %.1e of 0.01 g\n", off[0], off[1]);
  EXPECT_LT(off[1], 2e-3);
  EXPECT_NEAR(off[0] / off[1], 10.0, 0.1);
}

}  // namespace
}  // namespace vp::test
