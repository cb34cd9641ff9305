// Rounding of articulated dynamics: the two arithmetics against each other, identical bits on every
// machine where they are promised, and masses and lengths far from one.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "trees.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;

struct Results {
  Numbers a, tau, M;
};
Results all_of(const Model& model, const State& s, Arithmetic arithmetic) {
  Data data(model, arithmetic);
  Results out{Numbers(s.v.size()), Numbers(s.v.size()), Numbers(s.v.size() * s.v.size())};
  EXPECT_TRUE(forward_dynamics<double>(model, data, s.q, s.v, s.tau, {}, out.a));
  inverse_dynamics<double>(model, data, s.q, s.v, s.a, {}, out.tau);
  mass_matrix<double>(model, data, s.q, out.M);
  return out;
}

// Measured: at most 3e-14 of the largest value, and 0 on a machine with the baseline instruction
// set only.
TEST(Arithmetic, FastestAndReproducibleAgreeToRounding) {
  Random random(171);
  for (int round = 0; round < 50; ++round) {
    const Model model = random_tree(random, 15);
    const State s = random_state(random, model);
    const Results x = all_of(model, s, Arithmetic::fastest);
    const Results y = all_of(model, s, Arithmetic::reproducible);
    ASSERT_LT(largest_difference(x.a, y.a), 1e-12 * (1 + largest_of(y.a)));
    ASSERT_LT(largest_difference(x.tau, y.tau), 1e-12 * (1 + largest_of(y.tau)));
    ASSERT_LT(largest_difference(x.M, y.M), 1e-12 * (1 + largest_of(y.M)));
  }
}

// Lanes are independent. The slot groups of one state compute the same bits as a slot of a batch.
TEST(Arithmetic, ReproducibleHasTheSameBitsInEveryLane) {
  using P = PackT<double, 4>;
  Random random(174);
  for (int round = 0; round < 20; ++round) {
    const Model model = random_tree(random, 15);
    const auto n = static_cast<std::size_t>(model.velocities());
    std::vector<P> q(static_cast<std::size_t>(model.coordinates())), v(n), tau(n), a(n), out(n),
        M(n * n);
    std::vector<Results> alone;
    for (int lane = 0; lane < P::kLanes; ++lane) {
      State s = random_state(random, model);
      // An angle of many revolutions in one lane changes nothing in another.
      for (int link = 0; lane == 3 && link < model.links(); ++link) {
        if (!std::holds_alternative<RevoluteJoint>(model.link(link).joint)) continue;
        s.q[static_cast<std::size_t>(model.first_coordinate(link))] += 3e6;
        break;
      }
      for (std::size_t i = 0; i < q.size(); ++i) q[i].set(lane, s.q[i]);
      for (std::size_t i = 0; i < n; ++i) {
        v[i].set(lane, s.v[i]);
        tau[i].set(lane, s.tau[i]);
        a[i].set(lane, s.a[i]);
      }
      alone.push_back(all_of(model, s, Arithmetic::reproducible));
    }
    DataT<P> data(model, Arithmetic::reproducible);
    const auto lanes_are = [&](const std::vector<P>& lanes, Numbers Results::*expected) {
      for (int lane = 0; lane < P::kLanes; ++lane) {
        const Numbers& numbers = alone[static_cast<std::size_t>(lane)].*expected;
        for (std::size_t i = 0; i < numbers.size(); ++i) ASSERT_EQ(lanes[i][lane], numbers[i]);
      }
    };
    ASSERT_TRUE(forward_dynamics<P>(model, data, q, v, tau, {}, out));
    lanes_are(out, &Results::a);
    inverse_dynamics<P>(model, data, q, v, a, {}, out);
    lanes_are(out, &Results::tau);
    mass_matrix<P>(model, data, q, M);
    lanes_are(M, &Results::M);
  }
}

// FNV-1a over the bits. The constant is the same for every compiler, optimisation level and
// machine. A change of it is a change of results.
TEST(Arithmetic, ReproducibleHasGoldenBits) {
  Random random(172);
  std::uint64_t hash = 14695981039346656037u;
  const auto add = [&](const Numbers& numbers) {
    for (const double x : numbers) hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 1099511628211u;
  };
  for (int round = 0; round < 20; ++round) {
    const Model model = random_tree(random, 15);
    const Results r = all_of(model, random_state(random, model), Arithmetic::reproducible);
    add(r.a);
    add(r.tau);
    add(r.M);
  }
  EXPECT_EQ(hash, 17807220277372965333u);
}

// The same tree with every mass times `mass`, and every length and gravity times `length`.
// Rotations stay equal, translations scale by `length`, torques and forces follow.
struct Scaled {
  Model model;
  State state;
};
Scaled scaled(const Model& model, const State& s, double mass, double length) {
  ModelBuilder builder;
  State t = s;
  for (int i = 0; i < model.links(); ++i) {
    LinkSpec link = model.link(i);
    const SE3& X = link.T_parent_joint;
    link.T_parent_joint = SE3(X.rotation(), length * X.position());
    const Inertia& J = link.inertia;
    link.inertia = Inertia(mass * J.mass(), (mass * length) * J.first_moment(),
                           (mass * length * length) * J.rotational());
    const bool slides = std::holds_alternative<PrismaticJoint>(link.joint);
    if (auto* helical = std::get_if<HelicalJoint>(&link.joint)) helical->pitch *= length;
    const double force = slides ? mass * length : mass * length * length;
    const double resistance = slides ? mass : mass * length * length;
    link.armature *= resistance;
    link.damping *= resistance;
    must_build(builder.add(link));
    const auto k = static_cast<std::size_t>(model.first_velocity(i));
    if (slides) {
      t.q[k] *= length;
      t.v[k] *= length;
      t.a[k] *= length;
    }
    t.tau[k] *= force;
  }
  return {must_build(builder.build()), t};
}

// Measured: 2e-13.
TEST(Scales, OfMassAndLengthChangeNothingButUnits) {
  Random random(173);
  for (const double mass : {1e-9, 1.0, 1e9}) {
    for (const double length : {1e-9, 1.0, 1e9}) {
      for (int round = 0; round < 10; ++round) {
        const Model model = random_tree(random, 8, 3);
        const State s = random_state(random, model);
        const Scaled other = scaled(model, s, mass, length);
        Data data(model), far(other.model);
        Numbers a(s.v.size()), b(s.v.size());
        const Loads loads{.gravity = {1, 2, -9}};
        const Loads scaled_loads{.gravity = length * loads.gravity};
        ASSERT_TRUE(forward_dynamics<double>(model, data, s.q, s.v, s.tau, loads, a));
        ASSERT_TRUE(forward_dynamics<double>(other.model, far, other.state.q, other.state.v,
                                             other.state.tau, scaled_loads, b));
        for (int i = 0; i < model.links(); ++i) {
          const bool slides = std::holds_alternative<PrismaticJoint>(model.link(i).joint);
          const auto k = static_cast<std::size_t>(model.first_velocity(i));
          const double expected = slides ? length * a[k] : a[k];
          const double unit = slides ? length : 1.0;
          ASSERT_NEAR(b[k], expected, 1e-11 * unit * (1 + largest_of(a)))
              << mass << " kg " << length << " m";
        }
      }
    }
  }
}

}  // namespace
}  // namespace vp::test
