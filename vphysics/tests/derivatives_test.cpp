// Derivatives of the dynamics against difference quotients, whose error must fall with the square
// of the step, and to rounding against dual numbers through another recursion.
#include "vphysics/multibody/derivatives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "screws_joint.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;

struct Inverse {
  Numbers q, v, a;
};
Inverse inverse_slopes(const Model& model, const State& s, const Loads& loads) {
  Data data(model);
  DerivativesData memory(model);
  const std::size_t n = s.v.size();
  Inverse out{Numbers(n * n, 7.0), Numbers(n * n, 7.0), Numbers(n * n, 7.0)};
  const auto done = inverse_dynamics_derivatives<double>(model, data, memory, s.q, s.v, s.a, loads,
                                                         {out.q, out.v, out.a});
  EXPECT_TRUE(done) << done.error().message;
  return out;
}
struct Forward {
  Numbers a, q, v, tau;
};
Forward forward_slopes(const Model& model, const State& s, const Loads& loads) {
  Data data(model);
  DerivativesData memory(model);
  const std::size_t n = s.v.size();
  Forward out{Numbers(n), Numbers(n * n, 7.0), Numbers(n * n, 7.0), Numbers(n * n, 7.0)};
  const auto done = forward_dynamics_derivatives<double>(model, data, memory, s.q, s.v, s.tau,
                                                         loads, {out.a, out.q, out.v, out.tau});
  EXPECT_TRUE(done) << done.error().message;
  return out;
}

// The derivatives of f along each unit vector of the velocity space, by central differences.
Numbers difference_quotient(std::size_t n, double h,
                            const std::function<Numbers(const Numbers&)>& f) {
  Numbers out(n * n);
  for (std::size_t k = 0; k < n; ++k) {
    Numbers delta(n);
    delta[k] = h;
    const Numbers after = f(delta);
    delta[k] = -h;
    const Numbers before = f(delta);
    for (std::size_t i = 0; i < n; ++i) out[i * n + k] = (after[i] - before[i]) / (2 * h);
  }
  return out;
}
State moved(const Model& model, const State& s, const Numbers& q, const Numbers& v = {}) {
  State out = s;
  if (!q.empty()) out.q = stepped(model, s.q, q);
  for (std::size_t i = 0; i < v.size(); ++i) out.v[i] += v[i];
  return out;
}

// Checks one matrix at two step sizes: the error falls to a quarter, unless rounding dominates.
struct Order {
  int rounds = 0, checked = 0;
  double worst = 0.0;
  void check(const Numbers& exact, std::size_t n, const std::function<Numbers(const Numbers&)>& f) {
    const double coarse = largest_difference(difference_quotient(n, 1e-3, f), exact);
    const double fine = largest_difference(difference_quotient(n, 5e-4, f), exact);
    const double scale = 1 + largest_of(exact);
    ++rounds;
    worst = std::max(worst, fine / scale);
    EXPECT_LT(fine, 1e-4 * scale);
    if (fine < 1e-9 * scale) return;
    ++checked;
    EXPECT_NEAR(coarse / fine, 4.0, 0.15) << "round " << rounds << " error " << fine / scale;
  }
};

Loads some_loads(Random& random, std::vector<dse3>& external, const Model& model) {
  external.resize(static_cast<std::size_t>(model.links()));
  for (dse3& F : external) F = {random.in_cube(1), random.in_cube(1)};
  return {.gravity = random.in_cube(10), .external = external};
}

TEST(InverseDerivatives, AreTheSlopesOfInverseDynamicsOnTreesOfEveryJoint) {
  Random random(101);
  Order by_q, by_v;
  double by_a = 0.0;
  for (int round = 0; round < 12; ++round) {
    const Model model = tree_with_screws(random, 7);
    const State s = random_state(random, model);
    const std::size_t n = s.v.size();
    std::vector<dse3> external;
    const Loads loads = some_loads(random, external, model);
    const Inverse slopes = inverse_slopes(model, s, loads);
    Data data(model);
    const auto tau = [&](const State& at) {
      Numbers out(n);
      inverse_dynamics<double>(model, data, at.q, at.v, at.a, loads, out);
      return out;
    };
    by_q.check(slopes.q, n, [&](const Numbers& d) { return tau(moved(model, s, d)); });
    by_v.check(slopes.v, n, [&](const Numbers& d) { return tau(moved(model, s, {}, d)); });
    Numbers M(n * n);
    mass_matrix<double>(model, data, s.q, M);
    by_a = std::max(by_a, largest_difference(M, slopes.a) / (1 + largest_of(M)));
  }
  std::printf("by q: %.1e, order seen in %d of %d; by v: %.1e; by a: %.1e\n", by_q.worst,
              by_q.checked, by_q.rounds, by_v.worst, by_a);
  EXPECT_EQ(by_q.checked, by_q.rounds);
  EXPECT_LT(by_v.worst, 1e-9);  // f is quadratic, so only rounding remains
  EXPECT_LT(by_a, 1e-13);
}

TEST(ForwardDerivatives, AreTheSlopesOfForwardDynamicsOnTreesOfEveryJoint) {
  Random random(102);
  Order by_q, by_v;
  double by_tau = 0.0, off = 0.0;
  for (int round = 0; round < 12; ++round) {
    const Model model = tree_with_screws(random, 7);
    const State s = random_state(random, model);
    const std::size_t n = s.v.size();
    std::vector<dse3> external;
    const Loads loads = some_loads(random, external, model);
    const Forward slopes = forward_slopes(model, s, loads);
    Data data(model);
    const auto a = [&](const State& at) {
      Numbers out(n);
      EXPECT_TRUE(forward_dynamics<double>(model, data, at.q, at.v, at.tau, loads, out));
      return out;
    };
    by_q.check(slopes.q, n, [&](const Numbers& d) { return a(moved(model, s, d)); });
    by_v.check(slopes.v, n, [&](const Numbers& d) { return a(moved(model, s, {}, d)); });
    off = std::max(off, largest_difference(a(s), slopes.a));
    ASSERT_TRUE(factor_mass<double>(model, data, s.q));
    for (std::size_t k = 0; k < n; ++k) {
      Numbers x(n);
      x[k] = 1.0;
      solve_mass<double>(model, data, x);
      const double scale = 1 + largest_of(x);
      for (std::size_t i = 0; i < n; ++i) {
        by_tau = std::max(by_tau, std::fabs(x[i] - slopes.tau[i * n + k]) / scale);
      }
    }
  }
  std::printf("by q: %.1e, order seen in %d of %d; by v: %.1e; by tau: %.1e\n", by_q.worst,
              by_q.checked, by_q.rounds, by_v.worst, by_tau);
  EXPECT_EQ(by_q.checked, by_q.rounds);
  EXPECT_LT(by_v.worst, 1e-8);
  EXPECT_LT(by_tau, 1e-11);
  EXPECT_EQ(off, 0.0);
}

// --- dual numbers through the recursion in the links' frames

using D = DualT<double>;

// One joint's motion in the link's frame: its pose, S v, S a and (dS/dt) v; and S itself.
struct JointMotion {
  SE3T<D> X;
  std::vector<se3T<D>> S;
  se3T<D> rate;
};
// A product of screws. Each adds its motion to that of the screws before it.
JointMotion chain(const std::vector<se3>& screws, const D* q, const D* v) {
  JointMotion m;
  se3T<D> V, A;
  for (std::size_t k = 0; k < screws.size(); ++k) {
    const se3T<D> s = as<D>(screws[k]);
    const SE3T<D> step = Exp(q[k] * s);
    m.X = m.X * step;
    for (auto& S : m.S) S = Ad(Inv(step), S);
    m.S.push_back(s);
    V = Ad(Inv(step), V);
    A = Ad(Inv(step), A) + ad(V, v[k] * s);
    V = V + v[k] * s;
  }
  m.rate = A;  // relative acceleration at zero joint accelerations
  return m;
}
Vec3 unit(const Vec3& a) {
  return (1 / norm(a)) * a;
}
// delta: a tangent step from q, which has a derivative part only.
JointMotion motion_of(const Joint& joint, const double* q, const D* delta, const D* v) {
  const auto simple = [&](const std::vector<se3>& screws) {
    std::array<D, 3> at;
    for (std::size_t k = 0; k < screws.size(); ++k) at[k] = D(q[k]) + delta[k];
    return chain(screws, at.data(), v);
  };
  if (const auto* j = std::get_if<RevoluteJoint>(&joint)) return simple({{unit(j->axis), {}}});
  if (const auto* j = std::get_if<PrismaticJoint>(&joint)) return simple({{{}, unit(j->axis)}});
  if (const auto* j = std::get_if<HelicalJoint>(&joint)) {
    return simple({{unit(j->axis), j->pitch * unit(j->axis)}});
  }
  if (const auto* j = std::get_if<CylindricalJoint>(&joint)) {
    return simple({{{}, unit(j->axis)}, {unit(j->axis), {}}});
  }
  if (const auto* j = std::get_if<UniversalJoint>(&joint)) {
    return simple({{unit(j->first), {}}, {unit(j->second), {}}});
  }
  if (std::holds_alternative<PlanarJoint>(joint)) {
    return simple({{{}, {1, 0, 0}}, {{}, {0, 1, 0}}, {{0, 0, 1}, {}}});
  }
  JointMotion m;
  if (const auto* own = std::get_if<std::shared_ptr<const UserJoint>>(&joint)) {
    const auto* screws = dynamic_cast<const ScrewsJoint<2>*>(own->get());
    const std::array<D, 2> at = {D(q[0]) + delta[0], D(q[1]) + delta[1]}, rates = {v[0], v[1]};
    m.X = screws->pose(at);
    for (const auto& S : screws->subspace(at)) m.S.push_back(S);
    m.rate = screws->rate(at, rates);
    return m;
  }
  const bool free = std::holds_alternative<FreeJoint>(joint);
  const double* r = free ? q + 3 : q;
  const SE3 now(from_quaternion(Quaternion{r[0], r[1], r[2], r[3]}),
                free ? Vec3{q[0], q[1], q[2]} : Vec3{});
  const se3T<D> step{{delta[0], delta[1], delta[2]},
                     free ? Vec3T<D>{delta[3], delta[4], delta[5]} : Vec3T<D>{}};
  m.X = as<D>(now) * Exp(step);
  for (int k = 0; k < (free ? 6 : 3); ++k) {
    se3T<D> S;
    (k < 3 ? S.w : S.v)[k % 3] = D(1.0);
    m.S.push_back(S);
  }
  return m;
}

// tau with its derivative along (delta, dv), one direction.
std::vector<D> newton_euler(const Model& model, const State& s, const Loads& loads,
                            const std::vector<D>& delta, const std::vector<D>& v) {
  const auto links = static_cast<std::size_t>(model.links());
  std::vector<SE3T<D>> f(links);
  std::vector<se3T<D>> V(links), A(links);
  std::vector<dse3T<D>> F(links);
  std::vector<JointMotion> motions(links);
  std::vector<D> tau(s.v.size());
  const se3T<D> rest = {{}, {D(-loads.gravity.x), D(-loads.gravity.y), D(-loads.gravity.z)}};
  for (std::size_t l = 0; l < links; ++l) {
    const LinkSpec& link = model.link(static_cast<int>(l));
    const auto first = static_cast<std::size_t>(model.first_velocity(static_cast<int>(l)));
    const auto at = static_cast<std::size_t>(model.first_coordinate(static_cast<int>(l)));
    if (!std::holds_alternative<FixedJoint>(link.joint)) {
      motions[l] = motion_of(link.joint, s.q.data() + at, delta.data() + first, v.data() + first);
    }
    const JointMotion& m = motions[l];
    f[l] = as<D>(link.T_parent_joint) * m.X;
    const bool root = link.parent == kWorld;
    const auto p = static_cast<std::size_t>(link.parent);
    se3T<D> own, pushed = m.rate;
    for (std::size_t k = 0; k < m.S.size(); ++k) {
      own = own + v[first + k] * m.S[k];
      pushed = pushed + D(s.a[first + k]) * m.S[k];
    }
    V[l] = Ad(Inv(f[l]), root ? se3T<D>{} : V[p]) + own;
    A[l] = Ad(Inv(f[l]), root ? rest : A[p]) + ad(V[l], own) + pushed;
    const InertiaT<D> J = as<D>(link.inertia);
    const dse3& E = loads.external[l];
    F[l] = J * A[l] - dad(V[l], J * V[l]) -
           dse3T<D>{{D(E.m.x), D(E.m.y), D(E.m.z)}, {D(E.f.x), D(E.f.y), D(E.f.z)}};
  }
  for (std::size_t l = links; l-- > 0;) {
    const LinkSpec& link = model.link(static_cast<int>(l));
    const auto first = static_cast<std::size_t>(model.first_velocity(static_cast<int>(l)));
    for (std::size_t k = 0; k < motions[l].S.size(); ++k) {
      tau[first + k] = motions[l].S[k] * F[l] + D(link.damping) * v[first + k] +
                       D(link.armature * s.a[first + k]);
    }
    if (link.parent == kWorld) continue;
    dse3T<D>& sum = F[static_cast<std::size_t>(link.parent)];
    sum = sum + dAd(Inv(f[l]), F[l]);
  }
  return tau;
}

Model tree_for_duals(Random& random, int links) {
  ModelBuilder builder;
  for (int i = 0; i < links; ++i) {
    Joint joint = random_joint(random, i % 9);
    if (i % 10 == 9) joint = std::make_shared<ScrewsJoint<2>>(random);
    must_build(builder.add(
        {"link", static_cast<int>(random.word() % static_cast<unsigned>(i + 1)) - 1, joint,
         random.pose(0.5), random_body(random), 0.05, random.uniform(0.0, 0.2)}));
  }
  return must_build(builder.build());
}

TEST(InverseDerivatives, AreThoseOfDualNumbersInTheLinksFrames) {
  Random random(103);
  double worst = 0.0, value = 0.0;
  for (int round = 0; round < 3; ++round) {
    const Model model = tree_for_duals(random, 12);
    const State s = random_state(random, model);
    const std::size_t n = s.v.size();
    std::vector<dse3> external;
    const Loads loads = some_loads(random, external, model);
    const Inverse slopes = inverse_slopes(model, s, loads);
    Data data(model);
    Numbers expected(n);
    inverse_dynamics<double>(model, data, s.q, s.v, s.a, loads, expected);
    const double scale = 1 + largest_of(slopes.q) + largest_of(slopes.v);
    for (std::size_t k = 0; k < 2 * n; ++k) {
      std::vector<D> delta(n), v(s.v.begin(), s.v.end());
      (k < n ? delta[k] : v[k - n]).derivative[0] = 1.0;
      const std::vector<D> tau = newton_euler(model, s, loads, delta, v);
      for (std::size_t i = 0; i < n; ++i) {
        const double found = k < n ? slopes.q[i * n + k] : slopes.v[i * n + k - n];
        worst = std::max(worst, std::fabs(tau[i].derivative[0] - found) / scale);
        value = std::max(value, std::fabs(tau[i].value - expected[i]) / scale);
      }
    }
  }
  std::printf("worst: %.1e, of the force itself: %.1e\n", worst, value);
  EXPECT_LT(worst, 1e-13);
  EXPECT_LT(value, 1e-13);
}

// --- identities

TEST(ForwardDerivatives, InvertThoseOfInverseDynamics) {
  Random random(104);
  double worst = 0.0;
  for (int round = 0; round < 10; ++round) {
    const Model model = tree_with_screws(random, 12);
    State s = random_state(random, model);
    const std::size_t n = s.v.size();
    std::vector<dse3> external;
    const Loads loads = some_loads(random, external, model);
    const Forward forward = forward_slopes(model, s, loads);
    s.a = forward.a;
    const Inverse inverse = inverse_slopes(model, s, loads);
    const double scale = 1 + largest_of(forward.q) + largest_of(forward.v);
    // tau_q + M a_q = 0
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < n; ++k) {
        double by_q = inverse.q[i * n + k], by_v = inverse.v[i * n + k], one = i == k ? -1.0 : 0.0;
        for (std::size_t j = 0; j < n; ++j) {
          by_q += inverse.a[i * n + j] * forward.q[j * n + k];
          by_v += inverse.a[i * n + j] * forward.v[j * n + k];
          one += inverse.a[i * n + j] * forward.tau[j * n + k];
        }
        worst = std::max({worst, std::fabs(by_q) / scale, std::fabs(by_v) / scale, std::fabs(one)});
        ASSERT_EQ(forward.tau[i * n + k], forward.tau[k * n + i]);
      }
    }
  }
  std::printf("worst: %.1e\n", worst);
  EXPECT_LT(worst, 1e-11);
}

TEST(InverseDerivatives, OfADoublePendulumAreThoseInClosedForm) {
  // Point masses m1, m2 on massless rods l1, l2. theta2 is relative: the difference of the absolute
  // angles.
  const double m1 = 1.3, m2 = 0.7, l1 = 0.8, l2 = 1.1, g = 9.81;
  ModelBuilder builder;
  const auto point = [](double m, double l) {
    return Inertia(m, Vec3{0, -m * l, 0}, Sym3{m * l * l, 0, m * l * l, 0, 0, 0});
  };
  must_build(builder.add({"one", kWorld, RevoluteJoint{}, {}, point(m1, l1)}));
  must_build(builder.add({"two", 0, RevoluteJoint{}, SE3(Vec3{0, -l1, 0}), point(m2, l2)}));
  const Model model = must_build(builder.build());
  State s;
  s.q = {0.4, -1.1}, s.v = {0.9, -1.7}, s.a = {0.6, 2.2};
  const Inverse slopes = inverse_slopes(model, s, {.gravity = {0, -g, 0}});
  const double c2 = std::cos(s.q[1]), s2 = std::sin(s.q[1]), k = m2 * l1 * l2;
  const double c1 = std::cos(s.q[0]), c12 = std::cos(s.q[0] + s.q[1]);
  const double w1 = s.v[0], w2 = s.v[1], a1 = s.a[0], a2 = s.a[1];
  // tau1 = (m1 l1^2 + m2 (l1^2 + l2^2) + 2 k c2) a1 + (m2 l2^2 + k c2) a2 - k s2 (2 w1 w2 + w2^2)
  //        + (m1 + m2) g l1 sin q1 + m2 g l2 sin(q1 + q2)
  // tau2 = (m2 l2^2 + k c2) a1 + m2 l2^2 a2 + k s2 w1^2 + m2 g l2 sin(q1 + q2)
  const double tip = m2 * g * l2 * c12;
  const double by_q[4] = {(m1 + m2) * g * l1 * c1 + tip,
                          -2 * k * s2 * a1 - k * s2 * a2 - k * c2 * (2 * w1 * w2 + w2 * w2) + tip,
                          tip, -k * s2 * a1 + k * c2 * w1 * w1 + tip};
  const double by_v[4] = {-2 * k * s2 * w2, -2 * k * s2 * (w1 + w2), 2 * k * s2 * w1, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(slopes.q[i], by_q[i], 1e-14) << i;
    EXPECT_NEAR(slopes.v[i], by_v[i], 1e-14) << i;
  }
}

// Two separate trees do not affect each other, and their indices may be interleaved.
TEST(ForwardDerivatives, OfTwoTreesMixedAreThoseOfEach) {
  Random random(105);
  ModelBuilder mixed, alone[2];
  for (int i = 0; i < 12; ++i) {
    const int tree = i % 2, number = i / 2;
    const LinkSpec link{"link", number == 0 ? kWorld : 2 * (number - 1) + tree,
                        random_joint(random, i % 8), random.pose(0.5), random_body(random)};
    LinkSpec same = link;
    same.parent = number - 1;
    must_build(mixed.add(link));
    must_build(alone[tree].add(same));
  }
  const Model model = must_build(mixed.build());
  const State s = random_state(random, model);
  const Forward slopes = forward_slopes(model, s, {});
  const std::size_t n = s.v.size();
  for (int tree = 0; tree < 2; ++tree) {
    const Model part = must_build(alone[tree].build());
    State t;
    std::vector<std::size_t> numbers;
    for (int l = tree; l < 12; l += 2) {
      const Joint& joint = model.link(l).joint;
      for (int k = 0; k < coordinates_of(joint); ++k) {
        t.q.push_back(s.q[static_cast<std::size_t>(model.first_coordinate(l) + k)]);
      }
      for (int k = 0; k < velocities_of(joint); ++k) {
        numbers.push_back(static_cast<std::size_t>(model.first_velocity(l) + k));
        t.v.push_back(s.v[numbers.back()]);
        t.tau.push_back(s.tau[numbers.back()]);
      }
    }
    const Forward own = forward_slopes(part, t, {});
    const std::size_t m = t.v.size();
    for (std::size_t i = 0; i < m; ++i) {
      std::vector<bool> here(n);
      for (std::size_t k = 0; k < m; ++k) {
        here[numbers[k]] = true;
        EXPECT_NEAR(slopes.q[numbers[i] * n + numbers[k]], own.q[i * m + k], 1e-11);
        EXPECT_NEAR(slopes.v[numbers[i] * n + numbers[k]], own.v[i * m + k], 1e-11);
        EXPECT_NEAR(slopes.tau[numbers[i] * n + numbers[k]], own.tau[i * m + k], 1e-11);
      }
      for (std::size_t k = 0; k < n; ++k) {
        if (here[k]) continue;
        EXPECT_EQ(slopes.q[numbers[i] * n + k], 0.0);
        EXPECT_EQ(slopes.tau[numbers[i] * n + k], 0.0);
      }
    }
  }
}

// Measured: 3e-6 of the largest.
TEST(ForwardDerivatives, OfFloatsAreThoseOfDoubles) {
  Random random(106);
  double worst = 0.0;
  for (int round = 0; round < 20; ++round) {
    const Model model = random_tree(random, 10);
    const ModelT<float> narrow(model);
    const State s = random_state(random, model);
    const std::size_t n = s.v.size();
    const Forward wide = forward_slopes(model, s, {});
    const std::vector<float> q(s.q.begin(), s.q.end()), v(s.v.begin(), s.v.end()),
        tau(s.tau.begin(), s.tau.end());
    DataT<float> data(narrow);
    DerivativesDataT<float> memory(narrow);
    std::vector<float> a(n), a_q(n * n), a_v(n * n), a_tau(n * n);
    ASSERT_TRUE(forward_dynamics_derivatives<float>(narrow, data, memory, q, v, tau, {},
                                                    {a, a_q, a_v, a_tau}));
    const double scale = 1 + largest_of(wide.q) + largest_of(wide.v) + largest_of(wide.tau);
    worst = std::max({worst, largest_difference(wide.q, Numbers(a_q.begin(), a_q.end())) / scale,
                      largest_difference(wide.v, Numbers(a_v.begin(), a_v.end())) / scale,
                      largest_difference(wide.tau, Numbers(a_tau.begin(), a_tau.end())) / scale});
  }
  std::printf("worst: %.1e\n", worst);
  EXPECT_LT(worst, 1e-4);
}

// Values that a call leaves in the memory do not affect the next call, not even NaN.
TEST(ForwardDerivatives, DependOnNothingButTheirArguments) {
  Random random(108);
  const Model model = tree_with_screws(random, 12);
  const State s = random_state(random, model), other = random_state(random, model);
  const std::size_t n = s.v.size();
  const Forward fresh = forward_slopes(model, s, {});
  Data data(model);
  DerivativesData memory(model);
  Forward out{Numbers(n), Numbers(n * n), Numbers(n * n), Numbers(n * n)};
  const auto call = [&](const State& at) {
    return forward_dynamics_derivatives<double>(model, data, memory, at.q, at.v, at.tau, {},
                                                {out.a, out.q, out.v, out.tau});
  };
  ASSERT_TRUE(call(other));
  State broken = s;
  broken.v[0] = std::numeric_limits<double>::quiet_NaN();
  (void)call(broken);
  broken = s;
  broken.q.back() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(call(broken));
  ASSERT_TRUE(call(s));
  EXPECT_EQ(out.a, fresh.a);
  EXPECT_EQ(out.q, fresh.q);
  EXPECT_EQ(out.v, fresh.v);
  EXPECT_EQ(out.tau, fresh.tau);
}

// --- errors

TEST(ForwardDerivatives, SayWhereAJointMovesNoInertiaHere) {
  ModelBuilder builder;
  must_build(builder.add({.joint = RevoluteJoint{}, .inertia = Inertia(1.0, Vec3{1, 1, 0})}));
  const Model model = must_build(builder.build());
  Data data(model);
  DerivativesData memory(model);
  Numbers zero(1), a(1), a_q(1), a_v(1), a_tau(1);
  const auto done = forward_dynamics_derivatives<double>(model, data, memory, zero, zero, zero, {},
                                                         {a, a_q, a_v, a_tau});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::singular);
}

TEST(InverseDerivatives, SayWhereAJointOfOnesOwnDoesNotTellItsSlopes) {
  Random random(107);
  ModelBuilder builder;
  must_build(builder.add(
      {"own", kWorld, std::make_shared<ScrewsJoint<1>>(random, false), {}, random_body(random)}));
  const Model model = must_build(builder.build());
  const State s = random_state(random, model);
  Data data(model);
  DerivativesData memory(model);
  Numbers q(1), v(1), a(1);
  const auto done =
      inverse_dynamics_derivatives<double>(model, data, memory, s.q, s.v, s.a, {}, {q, v, a});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::unsupported);
  EXPECT_NE(done.error().message.find("inverse_dynamics_derivatives"), std::string::npos);
  EXPECT_NE(done.error().message.find("UserJoint::subspace_derivatives"), std::string::npos);
}

}  // namespace
}  // namespace vp::test
