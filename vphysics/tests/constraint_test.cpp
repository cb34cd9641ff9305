// Constraints and constrained dynamics, by independent routes: difference quotients of residuals,
// Eigen's dense solution of Gauss' principle, joints against their equivalents.
#include "vphysics/multibody/constraint.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <limits>

#include "trees.h"
#include "vphysics/multibody/configuration.h"
#include "vphysics/multibody/constrained_dynamics.h"

namespace vp::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Numbers = std::vector<double>;

ConstraintSet must_fit(const Model& model, std::vector<ConstraintPtr> constraints) {
  auto made = ConstraintSet::make(model, std::move(constraints));
  if (!made) ADD_FAILURE() << made.error().message;
  return made ? std::move(*made) : ConstraintSet();
}

// The first coordinate of the first joint with one degree of freedom.
CoupledCoordinate simple_coordinate(const Model& model, double factor) {
  for (int link = 0; link < model.links(); ++link) {
    if (coordinates_of(model.link(link).joint) == 1) return {link, 0, factor};
  }
  return {-1, 0, factor};
}

// Every kind of constraint, between links on different branches, on one path, and to the world.
std::vector<ConstraintPtr> every_kind(Random& random, const Model& model) {
  const auto place = [&](int link) { return Attachment{link, random.pose(0.5)}; };
  const int last = model.links() - 1;
  return {close_ball(place(last), place(last - 3)), close_hinge(place(last - 1), place(kWorld)),
          close_weld(place(last - 2), place(last)), keep_distance(place(0), place(last), 0.7),
          couple({simple_coordinate(model, 2.0)}, 0.3)};
}

Numbers residual_at(const Model& model, ConstrainedData& data, const Numbers& q) {
  const Numbers rest(static_cast<std::size_t>(model.velocities()));
  evaluate_constraints(model, data, q, rest);
  return {data.residual().begin(), data.residual().end()};
}
Numbers moved(const Model& model, const Numbers& q, const Numbers& v, double h) {
  Numbers delta, out(q.size());
  for (const double x : v) delta.push_back(h * x);
  integrate<double>(model, q, delta, out);
  return out;
}
// phi' = J v at (q, v).
Numbers rate_at(const Model& model, ConstrainedData& data, const Numbers& q, const Numbers& v) {
  evaluate_constraints(model, data, q, v);
  Numbers out;
  for (std::size_t i = 0; i < data.residual().size(); ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < v.size(); ++k) sum += data.jacobian()[i * v.size() + k] * v[k];
    out.push_back(sum);
  }
  return out;
}

// Central differences at two steps with Richardson extrapolation, (4 D(h/2) - D(h)) / 3: the error
// is of fourth order. Measured: 3e-10 of the largest.
template <class F>
Numbers slope(const F& f) {
  const auto difference = [&](double h) {
    const Numbers ahead = f(h), behind = f(-h);
    Numbers out;
    for (std::size_t i = 0; i < ahead.size(); ++i) out.push_back((ahead[i] - behind[i]) / (2 * h));
    return out;
  };
  const double h = 2e-3;
  const Numbers whole = difference(h), half = difference(h / 2);
  Numbers out;
  for (std::size_t i = 0; i < whole.size(); ++i) out.push_back((4 * half[i] - whole[i]) / 3);
  return out;
}

TEST(Constraint, HasTheRatesOfItsResidual) {
  Random random(81);
  double worst_J = 0.0, worst_b = 0.0;
  for (int round = 0; round < 40; ++round) {
    const Model model = random_tree(random, 10);
    if (simple_coordinate(model, 1).link < 0) continue;
    ConstrainedData data(model, must_fit(model, every_kind(random, model)));
    const State s = random_state(random, model);
    const Numbers phi = residual_at(model, data, s.q);
    if (largest_of(phi) > 8.0) continue;  // near the half revolution that the rows exclude
    const Numbers rate =
        slope([&](double h) { return residual_at(model, data, moved(model, s.q, s.v, h)); });
    const Numbers expected = rate_at(model, data, s.q, s.v);
    const double scale = 1 + largest_of(expected);
    worst_J = std::max(worst_J, largest_difference(rate, expected) / scale);
    const Numbers bias =
        slope([&](double h) { return rate_at(model, data, moved(model, s.q, s.v, h), s.v); });
    evaluate_constraints(model, data, s.q, s.v);
    const Numbers b(data.bias().begin(), data.bias().end());
    worst_b = std::max(worst_b, largest_difference(bias, b) / (1 + largest_of(b)));
  }
  std::printf("worst: J %.1e, b %.1e\n", worst_J, worst_b);
  EXPECT_LT(worst_J, 1e-7);
  EXPECT_LT(worst_b, 1e-7);
}

// Gauss' principle: of all a with J a + b = 0, the one closest to the free acceleration in the
// metric M. By singular values: a = a_0 + Z z, Z the null space of J.
Vector gauss(const Matrix& M, const Matrix& J, const Vector& b, const Vector& a_free) {
  Eigen::JacobiSVD<Matrix> svd(J, Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(1e-10);
  const Vector a0 = svd.solve(-b);
  const Matrix Z = svd.matrixV().rightCols(J.cols() - svd.rank());
  if (Z.cols() == 0) return a0;
  const Matrix N = Z.transpose() * M * Z;
  return a0 + Z * N.ldlt().solve(Z.transpose() * M * (a_free - a0));
}

// Loops that are closed in the current configuration, each twice, so that half of the rows are
// redundant.
TEST(ConstrainedDynamics, ObeysGaussPrincipleWithRedundantRows) {
  Random random(82);
  double worst = 0.0;
  for (int round = 0; round < 40; ++round) {
    const Model model = random_tree(random, 10);
    const State s = random_state(random, model);
    Data links(model);
    forward_kinematics<double>(model, links, s.q, {});
    const auto closed_here = [&](int a, int b) {
      const SE3 X = T_world_link<double>(model, links, a), P = random.pose(0.4);
      return std::pair{Attachment{a, P},
                       Attachment{b, Inv(T_world_link<double>(model, links, b)) * X * P}};
    };
    const auto [a, b] = closed_here(9, 4);
    const auto [c, d] = closed_here(8, 2);
    ConstrainedData data(model, must_fit(model, {close_hinge(a, b), close_hinge(b, a),
                                                 close_ball(c, d), close_ball(c, d)}));
    std::vector<dse3> external(static_cast<std::size_t>(model.links()));
    for (dse3& F : external) F = {random.in_cube(1), random.in_cube(1)};
    const Loads loads{.gravity = random.in_cube(10), .external = external};
    Numbers v = s.v, acceleration(v.size()), free(v.size());
    ASSERT_TRUE(project_velocities(model, data, s.q, v));
    const auto done =
        constrained_forward_dynamics(model, data, s.q, v, s.tau, loads, 0.0, acceleration);
    ASSERT_TRUE(done) << done.error().message;
    ASSERT_TRUE(forward_dynamics<double>(model, links, s.q, v, s.tau, loads, free));
    const auto n = static_cast<long>(v.size()), m = static_cast<long>(data.residual().size());
    Numbers mass(v.size() * v.size());
    mass_matrix<double>(model, links, s.q, mass);
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Matrix J = Eigen::Map<const Rows>(data.jacobian().data(), m, n);
    const Vector expected =
        gauss(Eigen::Map<Matrix>(mass.data(), n, n), J,
              Eigen::Map<const Vector>(data.bias().data(), m), Eigen::Map<Vector>(free.data(), n));
    const Vector got = Eigen::Map<Vector>(acceleration.data(), n);
    const double scale = 1 + expected.cwiseAbs().maxCoeff();
    worst = std::max(worst, (got - expected).cwiseAbs().maxCoeff() / scale);
    EXPECT_LE(data.rank(), 8);
    // The multipliers are the constraint forces: applied as loads, they give the same
    // accelerations.
    const Vector lambda = Eigen::Map<const Vector>(data.multipliers().data(), m);
    Numbers with(v.size());
    Eigen::Map<Vector>(with.data(), n) =
        Eigen::Map<const Vector>(s.tau.data(), n) + J.transpose() * lambda;
    ASSERT_TRUE(forward_dynamics<double>(model, links, s.q, v, with, loads, free));
    EXPECT_LT(largest_difference(free, acceleration), 1e-9 * (1 + largest_of(with)));
  }
  std::printf("worst: %.1e\n", worst);
  EXPECT_LT(worst, 1e-9);
}

// A helical joint equals a cylindrical joint with a coupling between rotation and translation.
TEST(Coupling, OfACylindricalJointIsAHelicalOne) {
  Random random(83);
  const Vec3 axis = random.direction();
  const double pitch = 0.13;
  const Inertia base = random_body(random), body = random_body(random), tip = random_body(random);
  const SE3 place = random.pose(1), onwards = random.pose(1);
  const auto build = [&](const Joint& joint) {
    ModelBuilder builder;
    must_build(builder.add({"base", kWorld, BallJoint{}, {}, base}));
    must_build(builder.add({"nut", 0, joint, place, body}));
    must_build(builder.add({"tip", 1, RevoluteJoint{{0, 1, 0}}, onwards, tip}));
    return must_build(builder.build());
  };
  const Model screw = build(HelicalJoint{axis, pitch}), nut = build(CylindricalJoint{axis});
  ConstrainedData data(nut, must_fit(nut, {couple({{1, 0, 1.0}, {1, 1, -pitch}})}));
  Data links(screw);
  for (int round = 0; round < 50; ++round) {
    State s = random_state(random, screw), t;
    // base (4, 3), nut, tip
    t.q = {s.q[0], s.q[1], s.q[2], s.q[3], pitch * s.q[4], s.q[4], s.q[5]};
    t.v = {s.v[0], s.v[1], s.v[2], pitch * s.v[3], s.v[3], s.v[4]};
    t.tau = {s.tau[0], s.tau[1], s.tau[2], 0.0, s.tau[3], s.tau[4]};
    t.a.resize(6);
    ASSERT_TRUE(forward_dynamics<double>(screw, links, s.q, s.v, s.tau, {}, s.a));
    ASSERT_TRUE(constrained_forward_dynamics(nut, data, t.q, t.v, t.tau, {}, 0.0, t.a));
    const Numbers expected = {s.a[0], s.a[1], s.a[2], pitch * s.a[3], s.a[3], s.a[4]};
    EXPECT_LT(largest_difference(t.a, expected), 1e-11 * (1 + largest_of(expected)));
  }
}

// A weld closes a chain to a tree: a welded link with a free joint moves as a fixed one.
TEST(Closure, AWeldedLinkIsAFixedOne) {
  Random random(84);
  const Inertia first = random_body(random), second = random_body(random);
  const SE3 place = random.pose(1), grip = random.pose(1);
  ModelBuilder apart, together;
  must_build(apart.add({"first", kWorld, RevoluteJoint{{0, 1, 0}}, grip, first}));
  must_build(apart.add({"second", kWorld, FreeJoint{}, SE3(Vec3{1e3, 0, 0}), second}));
  must_build(together.add({"first", kWorld, RevoluteJoint{{0, 1, 0}}, grip, first}));
  must_build(together.add({"second", 0, FixedJoint{}, place, second}));
  const Model loose = must_build(apart.build()), fixed = must_build(together.build());
  ConstrainedData data(loose, must_fit(loose, {close_weld({0, place}, {1, {}})}));
  Data links(fixed);
  for (int round = 0; round < 20; ++round) {
    const Numbers q = {random.uniform(-3, 3)}, v = {random.uniform(-5, 5)};
    Numbers a(1), tau(1), p(8), w(7), b(7), load(7);
    p[0] = q[0];
    for (int i = 0; i < 3; ++i) p[static_cast<std::size_t>(i + 1)] = random.uniform(-1, 1);
    p[1] -= 1e3;
    p[7] = 1.0;
    w[0] = v[0];
    const int held[] = {0};
    const auto steps = close_loops(loose, data, p, {.held = held});
    ASSERT_TRUE(steps) << steps.error().message;
    EXPECT_EQ(p[0], q[0]);
    // The velocity of the welded body: that of the first body's point at its place.
    const se3 V = InvAd(place, v[0] * se3{{0, 1, 0}, {}});
    const double parts[] = {V.w.x, V.w.y, V.w.z, V.v.x, V.v.y, V.v.z};
    std::copy(parts, parts + 6, w.begin() + 1);
    ASSERT_TRUE(constrained_forward_dynamics(loose, data, p, w, load, {}, 0.0, b));
    ASSERT_TRUE(forward_dynamics<double>(fixed, links, q, v, tau, {}, a));
    EXPECT_NEAR(a[0], b[0], 1e-9 * (1 + std::fabs(a[0])));
  }
}

// --- a user-defined constraint: the bead's z and x obey z = x^2

class ParabolicWire final : public Constraint {
 public:
  explicit ParabolicWire(int link) : link_(link) {}
  int rows() const override { return 1; }
  void evaluate(const ConstraintView& at, const ConstraintRows& out) const override {
    const SE3 X = at.T_world_link(link_);
    const Vec3 p = X.position(), v = X.rotate(at.velocity(link_).v);
    const se3 A = at.bias(link_), V = at.velocity(link_);
    const Vec3 a = X.rotate(A.v + cross(V.w, V.v));
    const Vec3 normal{-2 * p.x, 0, 1};
    out.residual[0] = p.z - p.x * p.x;
    out.bias[0] = dot(normal, a) - 2 * v.x * v.x;
    at.add(out, 0, link_, {{}, X.unrotate(normal)});
  }

 private:
  int link_;
};

// Lagrange's equation: (1 + 4 x^2) x'' + 4 x x'^2 + 2 g x = 0.
TEST(Constraint, OfOnesOwnIsABeadOnAWire) {
  ModelBuilder builder;
  must_build(builder.add({"bead", kWorld, FreeJoint{}, {}, Inertia(0.3, Vec3{1e-3, 1e-3, 1e-3})}));
  const Model model = must_build(builder.build());
  ConstrainedData data(model, must_fit(model, {std::make_shared<ParabolicWire>(0)}));
  Random random(85);
  for (int round = 0; round < 20; ++round) {
    State s = random_state(random, model);
    const double x = random.uniform(-2, 2), vx = random.uniform(-3, 3);
    s.q[0] = x;
    s.q[2] = x * x;
    const Mat3 R = from_quaternion(Quaternion{s.q[3], s.q[4], s.q[5], s.q[6]});
    const Vec3 w{s.v[0], s.v[1], s.v[2]}, v = transposed_times(R, Vec3{vx, 0, 2 * x * vx});
    for (std::size_t i = 0; i < 3; ++i) s.v[3 + i] = v[static_cast<int>(i)];
    std::fill(s.tau.begin(), s.tau.end(), 0.0);
    ASSERT_TRUE(constrained_forward_dynamics(model, data, s.q, s.v, s.tau, {}, 0.0, s.a));
    const Vec3 a = R * (Vec3{s.a[3], s.a[4], s.a[5]} + cross(w, v));
    const double expected = -(4 * x * vx * vx + 2 * 9.81 * x) / (1 + 4 * x * x);
    EXPECT_NEAR(a.x, expected, 1e-10 * (1 + std::fabs(expected)));
  }
}

// --- rejected arguments

TEST(ConstraintSet, RefusesWhatDoesNotFit) {
  Random random(86);
  ModelBuilder builder;
  must_build(builder.add({"ball", kWorld, BallJoint{}, {}, random_body(random)}));
  must_build(builder.add({"arm", 0, RevoluteJoint{}, random.pose(1), random_body(random)}));
  const Model model = must_build(builder.build());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const ConstraintPtr& constraint) {
    const auto made = ConstraintSet::make(model, {constraint});
    return !made && made.error().code == Errc::invalid_argument && !made.error().message.empty();
  };
  EXPECT_TRUE(refused(nullptr));
  EXPECT_TRUE(refused(close_ball({0, {}}, {2, {}})));
  EXPECT_TRUE(refused(close_hinge({-2, {}}, {1, {}})));
  EXPECT_TRUE(refused(close_weld({1, {}}, {1, SE3(Vec3{1, 0, 0})})));
  EXPECT_TRUE(refused(close_ball({0, {}}, {1, SE3(Vec3{nan, 0, 0})})));
  EXPECT_TRUE(refused(keep_distance({0, {}}, {1, {}}, 0.0)));
  EXPECT_TRUE(refused(keep_distance({0, {}}, {1, {}}, nan)));
  EXPECT_TRUE(refused(couple({})));
  EXPECT_TRUE(refused(couple({{0, 0, 1.0}})));  // a quaternion's component
  EXPECT_TRUE(refused(couple({{1, 1, 1.0}})));
  EXPECT_TRUE(refused(couple({{1, 0, nan}})));
  EXPECT_TRUE(refused(couple({{1, 0, 1.0}}, nan)));
  EXPECT_FALSE(refused(close_ball({0, {}}, {1, {}})));
}

// Two gears that prescribe different positions for the same joint.
TEST(ConstrainedDynamics, SaysThatConstraintsContradictEachOther) {
  ModelBuilder builder;
  must_build(builder.add({.joint = RevoluteJoint{}, .inertia = Inertia(1.0, Vec3{1, 1, 1})}));
  const Model model = must_build(builder.build());
  const auto wants = [](double angle) { return couple({{0, 0, 1.0}}, angle); };
  ConstrainedData data(model, must_fit(model, {wants(0.1), wants(0.2)}));
  Numbers q(1), v(1), tau(1), a(1);
  const auto accelerated = constrained_forward_dynamics(model, data, q, v, tau, {}, 10.0, a);
  ASSERT_FALSE(accelerated);
  EXPECT_EQ(accelerated.error().code, Errc::singular);
  const auto assembled = close_loops(model, data, q);
  ASSERT_FALSE(assembled);
  EXPECT_EQ(assembled.error().code, Errc::singular);
  EXPECT_TRUE(std::isfinite(q[0]));
  // The same constraint twice is redundant, not contradictory.
  ConstrainedData twice(model, must_fit(model, {wants(0.1), wants(0.1)}));
  EXPECT_TRUE(close_loops(model, twice, q));
  EXPECT_NEAR(q[0], 0.1, 1e-12);
  EXPECT_TRUE(constrained_forward_dynamics(model, twice, q, v, tau, {}, 10.0, a));
}

// A bar of zero length, two links too far apart, and a singular inertia.
TEST(ConstrainedDynamics, GivesAnErrorAndNoNaN) {
  ModelBuilder builder;
  const Inertia body(1.0, Vec3{1, 1, 1});
  must_build(builder.add({"a", kWorld, PrismaticJoint{{1, 0, 0}}, {}, body}));
  must_build(builder.add({"b", kWorld, PrismaticJoint{{1, 0, 0}}, SE3(Vec3{0, 2, 0}), body}));
  const Model model = must_build(builder.build());
  Numbers q(2);
  ConstrainedData far(model, must_fit(model, {keep_distance({0, {}}, {1, {}}, 1.0)}));
  EXPECT_FALSE(close_loops(model, far, q));  // 2 m apart in every configuration
  const SE3 beside(Vec3{0, 2, 0});
  ConstrainedData none(model, must_fit(model, {keep_distance({0, beside}, {1, {}}, 1.0)}));
  EXPECT_FALSE(close_loops(model, none, q));  // d = 0: the direction is undefined
  EXPECT_TRUE(std::isfinite(q[0]) && std::isfinite(q[1]));
  q[1] = 0.01;
  EXPECT_TRUE(close_loops(model, none, q));
  EXPECT_NEAR(std::fabs(q[1] - q[0]), 1.0, 1e-12);

  ModelBuilder needle;
  must_build(needle.add({.joint = RevoluteJoint{}, .inertia = Inertia(1.0, Vec3{1, 1, 0})}));
  const Model thin = must_build(needle.build());
  ConstrainedData data(thin, must_fit(thin, {couple({{0, 0, 1.0}}, 1.0)}));
  Numbers p(1), v(1), a(1);
  EXPECT_FALSE(close_loops(thin, data, p));
  EXPECT_FALSE(project_velocities(thin, data, p, v));
  EXPECT_FALSE(constrained_forward_dynamics(thin, data, p, v, v, {}, 0.0, a));
}

}  // namespace
}  // namespace vp::test
