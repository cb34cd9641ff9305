// Derivatives of packs of states: each lane has the derivatives of its own state. An independent
// route for forward dynamics: the solution of M da = -dtau with the derivatives of inverse
// dynamics.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "screws_joint.h"
#include "vphysics/multibody/derivatives.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;

// The results of one call in one lane: a, and three matrices.
struct Derivatives {
  Numbers a, q, v, force;
};

// One state for each lane, with loads of its own, and the results of the calls.
template <class B, int N>
class Pack {
 public:
  using P = PackT<B, N>;

  Pack(const Model& model, const std::vector<State>& states, Random& random)
      : model_(model),
        q_(packed(states, &State::q)),
        v_(packed(states, &State::v)),
        tau_(packed(states, &State::tau)),
        a_(packed(states, &State::a)),
        external_(static_cast<std::size_t>(model.links())) {
    for (int lane = 0; lane < N; ++lane) {
      std::vector<dse3> alone;
      for (auto& F : external_) {
        alone.push_back({random.in_cube(1), random.in_cube(1)});
        for (int k = 0; k < 3; ++k) {
          F.m[k].set(lane, static_cast<B>(alone.back().m[k]));
          F.f[k].set(lane, static_cast<B>(alone.back().f[k]));
        }
      }
      alone_.push_back(alone);
      gravity_.push_back(random.in_cube(10));
      for (int k = 0; k < 3; ++k) {
        loads_.gravity[k].set(lane, static_cast<B>(gravity_.back()[k]));
      }
    }
    loads_.external = external_;
  }

  Expected<void> forward(Arithmetic arithmetic = Arithmetic::fastest) {
    return call(arithmetic, [&](auto& data, auto& memory, auto& out) {
      return forward_dynamics_derivatives<P>(model_, data, memory, q_, v_, tau_, loads_,
                                             {out.a, out.q, out.v, out.force});
    });
  }
  Expected<void> inverse(Arithmetic arithmetic = Arithmetic::fastest) {
    return call(arithmetic, [&](auto& data, auto& memory, auto& out) {
      return inverse_dynamics_derivatives<P>(model_, data, memory, q_, v_, a_, loads_,
                                             {out.q, out.v, out.force});
    });
  }
  // Makes the accelerations of the last call the argument of inverse dynamics.
  void take_accelerations() { a_ = out_.a; }
  Derivatives lane(int lane) const {
    const auto numbers = [&](const std::vector<P>& packs) {
      Numbers out;
      for (const P& x : packs) out.push_back(static_cast<double>(x[lane]));
      return out;
    };
    return {numbers(out_.a), numbers(out_.q), numbers(out_.v), numbers(out_.force)};
  }
  Loads loads(int lane) const {
    const auto l = static_cast<std::size_t>(lane);
    return {.gravity = gravity_[l], .external = alone_[l]};
  }
  void set_velocity(std::size_t k, int lane, B value) { v_[k].set(lane, value); }

 private:
  struct Out {
    std::vector<P> a, q, v, force;
  };

  static std::vector<P> packed(const std::vector<State>& states, Numbers State::*numbers) {
    std::vector<P> out((states[0].*numbers).size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      for (int lane = 0; lane < N; ++lane) {
        out[i].set(lane, static_cast<B>((states[static_cast<std::size_t>(lane)].*numbers)[i]));
      }
    }
    return out;
  }
  template <class F>
  Expected<void> call(Arithmetic arithmetic, const F& f) {
    const std::size_t n = v_.size();
    const P other(B(7));
    out_ = {std::vector<P>(n, other), std::vector<P>(n * n, other), std::vector<P>(n * n, other),
            std::vector<P>(n * n, other)};
    DataT<P> data(model_, arithmetic);
    DerivativesDataT<P> memory(model_);
    return f(data, memory, out_);
  }

  ModelT<B> model_;
  std::vector<P> q_, v_, tau_, a_;
  std::vector<dse3T<P>> external_;
  std::vector<std::vector<dse3>> alone_;
  std::vector<Vec3> gravity_;
  LoadsT<P> loads_;
  Out out_;
};

Derivatives forward_alone(const Model& model, const State& s, const Loads& loads,
                          Arithmetic arithmetic = Arithmetic::fastest) {
  Data data(model, arithmetic);
  DerivativesData memory(model);
  const std::size_t n = s.v.size();
  Derivatives out{Numbers(n), Numbers(n * n), Numbers(n * n), Numbers(n * n)};
  EXPECT_TRUE(forward_dynamics_derivatives<double>(model, data, memory, s.q, s.v, s.tau, loads,
                                                   {out.a, out.q, out.v, out.force}));
  return out;
}
Derivatives inverse_alone(const Model& model, const State& s, const Loads& loads,
                          Arithmetic arithmetic = Arithmetic::fastest) {
  Data data(model, arithmetic);
  DerivativesData memory(model);
  const std::size_t n = s.v.size();
  Derivatives out{Numbers{}, Numbers(n * n), Numbers(n * n), Numbers(n * n)};
  EXPECT_TRUE(inverse_dynamics_derivatives<double>(model, data, memory, s.q, s.v, s.a, loads,
                                                   {out.q, out.v, out.force}));
  return out;
}
double difference_of(const Derivatives& x, const Derivatives& y) {
  const auto relative = [](const Numbers& a, const Numbers& b) {
    return largest_difference(a, b) / (1 + largest_of(b));
  };
  return std::max({relative(x.q, y.q), relative(x.v, y.v), relative(x.force, y.force)});
}

// Floating robots: two free roots, each with every kind of joint on it, their link indices
// interleaved.
Model floating_trees(Random& random) {
  ModelBuilder builder;
  for (int i = 0; i < 16; ++i) {
    LinkSpec link;
    link.joint = FreeJoint{};
    if (i >= 2) {
      link.parent = 2 * static_cast<int>(random.word() % static_cast<unsigned>(i / 2)) + i % 2;
      link.joint = random_joint(random, (i - 2) % 10);
      if (i >= 12) link.joint = std::make_shared<ScrewsJoint<2>>(random);
    }
    link.T_parent_joint = random.pose(0.5);
    link.inertia = random_body(random);
    link.armature = random.uniform(0.0, 0.1);
    link.damping = random.uniform(0.0, 0.2);
    must_build(builder.add(link));
  }
  return must_build(builder.build());
}
Model chain_of(Random& random, int links) {
  ModelBuilder builder;
  for (int i = 0; i < links; ++i) {
    must_build(builder.add({.name = "link",
                            .parent = i - 1,
                            .joint = RevoluteJoint{random.direction()},
                            .T_parent_joint = random.pose(0.1),
                            .inertia = random_body(random),
                            .armature = 0.05}));
  }
  return must_build(builder.build());
}
std::vector<Model> models(Random& random) {
  std::vector<Model> out;
  for (int round = 0; round < 6; ++round) out.push_back(tree_with_screws(random, 12));
  for (int round = 0; round < 4; ++round) out.push_back(floating_trees(random));
  out.push_back(chain_of(random, 60));
  return out;
}
std::vector<State> states_of(Random& random, const Model& model, int count) {
  std::vector<State> states;
  for (int i = 0; i < count; ++i) states.push_back(random_state(random, model));
  return states;
}

template <class B, int N>
void lanes_are_states(unsigned seed, double bound) {
  Random random(seed);
  double worst = 0.0;
  for (const Model& model : models(random)) {
    const std::vector<State> states = states_of(random, model, N);
    Pack<B, N> pack(model, states, random);
    const auto compare = [&](const auto& alone) {
      for (int lane = 0; lane < N; ++lane) {
        const State& s = states[static_cast<std::size_t>(lane)];
        worst = std::max(worst, difference_of(pack.lane(lane), alone(model, s, pack.loads(lane))));
      }
    };
    ASSERT_TRUE(pack.forward());
    compare([](const Model& m, const State& s, const Loads& l) { return forward_alone(m, s, l); });
    ASSERT_TRUE(pack.inverse());
    compare([](const Model& m, const State& s, const Loads& l) { return inverse_alone(m, s, l); });
  }
  std::printf("%d lanes of %d bytes: %.1e\n", N, static_cast<int>(sizeof(B)), worst);
  EXPECT_LT(worst, bound);
}

// Measured: 6e-14 in double, 2.4e-5 in float, of the largest number.
TEST(PackDerivatives, AreThoseOfEachState) {
  lanes_are_states<double, 4>(301, 1e-12);
#ifndef VP_FEW_SCALARS
  lanes_are_states<double, 8>(302, 1e-12);
  lanes_are_states<float, 8>(303, 2e-4);
  lanes_are_states<float, 16>(304, 2e-4);
#endif
}

// tau_q + M a_q = 0, tau_v + M a_v = 0, M a_tau = 1: forward dynamics by articulated inertias
// against composite inertias.
TEST(PackDerivatives, OfForwardDynamicsSolveThoseOfInverseDynamics) {
  Random random(305);
  double worst = 0.0;
  for (const Model& model : models(random)) {
    Pack<double, 4> pack(model, states_of(random, model, 4), random);
    ASSERT_TRUE(pack.forward());
    std::vector<Derivatives> forward;
    for (int lane = 0; lane < 4; ++lane) forward.push_back(pack.lane(lane));
    pack.take_accelerations();
    ASSERT_TRUE(pack.inverse());
    const auto n = static_cast<std::size_t>(model.velocities());
    for (int lane = 0; lane < 4; ++lane) {
      const Derivatives f = forward[static_cast<std::size_t>(lane)], i = pack.lane(lane);
      const double scale = (1 + largest_of(f.q) + largest_of(f.v)) * (1 + largest_of(i.force));
      for (std::size_t row = 0; row < n; ++row) {
        for (std::size_t column = 0; column < n; ++column) {
          double by_q = i.q[row * n + column], by_v = i.v[row * n + column];
          double one = row == column ? -1.0 : 0.0;
          for (std::size_t k = 0; k < n; ++k) {
            by_q += i.force[row * n + k] * f.q[k * n + column];
            by_v += i.force[row * n + k] * f.v[k * n + column];
            one += i.force[row * n + k] * f.force[k * n + column];
          }
          worst = std::max(
              {worst, std::fabs(by_q) / scale, std::fabs(by_v) / scale, std::fabs(one) / scale});
          ASSERT_EQ(f.force[row * n + column], f.force[column * n + row]);
        }
      }
    }
  }
  std::printf("worst: %.1e\n", worst);
  EXPECT_LT(worst, 1e-14);  // measured: 4e-16
}

TEST(PackDerivatives, ReproducibleOnesHaveTheSameBitsInEveryLane) {
  Random random(306);
  for (const Model& model : models(random)) {
    const std::vector<State> states = states_of(random, model, 4);
    Pack<double, 4> pack(model, states, random);
    const auto compare = [&](const auto& alone) {
      for (int lane = 0; lane < 4; ++lane) {
        const Derivatives found = pack.lane(lane);
        const Derivatives expected = alone(model, states[static_cast<std::size_t>(lane)],
                                           pack.loads(lane), Arithmetic::reproducible);
        ASSERT_EQ(found.q, expected.q);
        ASSERT_EQ(found.v, expected.v);
        ASSERT_EQ(found.force, expected.force);
      }
    };
    ASSERT_TRUE(pack.forward(Arithmetic::reproducible));
    compare(forward_alone);
    ASSERT_TRUE(pack.inverse(Arithmetic::reproducible));
    compare(inverse_alone);
  }
}

// FNV-1a over the bits. The constant is the same for every compiler, optimisation level and
// machine. A change of it is a change of results.
TEST(Derivatives, ReproducibleOnesHaveGoldenBits) {
  Random random(310);
  std::uint64_t hash = 14695981039346656037u;
  const auto add = [&](const Derivatives& derivatives) {
    for (const auto* numbers : {&derivatives.q, &derivatives.v, &derivatives.force}) {
      for (const double x : *numbers) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 1099511628211u;
      }
    }
  };
  for (int round = 0; round < 10; ++round) {
    const Model model = random_tree(random, 15);
    const State s = random_state(random, model);
    add(forward_alone(model, s, {}, Arithmetic::reproducible));
    add(inverse_alone(model, s, {}, Arithmetic::reproducible));
  }
  EXPECT_EQ(hash, 9237749921117450970u);
}

TEST(PackDerivatives, OfOneLaneDoNotKnowOfAnother) {
  Random random(307);
  const Model model = floating_trees(random);
  const std::vector<State> states = states_of(random, model, 4);
  Pack<double, 4> pack(model, states, random);
  ASSERT_TRUE(pack.forward());
  const Derivatives before = pack.lane(1);
  pack.set_velocity(8, 2, std::numeric_limits<double>::quiet_NaN());
  pack.set_velocity(9, 3, 100.0);
  (void)pack.forward();
  const Derivatives after = pack.lane(1);
  EXPECT_EQ(before.a, after.a);
  EXPECT_EQ(before.q, after.q);
  EXPECT_EQ(before.v, after.v);
  EXPECT_EQ(before.force, after.force);
  EXPECT_NE(pack.lane(3).v, before.v);
}

// --- rejected arguments

// A mass that slides along an arm: it resists the arm's rotation except at the hinge.
TEST(PackDerivatives, AreRefusedWhereOneLaneMovesNoInertia) {
  ModelBuilder builder;
  must_build(builder.add({.name = "arm", .joint = RevoluteJoint{{0, 0, 1}}}));
  must_build(builder.add({.name = "mass",
                          .parent = 0,
                          .joint = PrismaticJoint{{1, 0, 0}},
                          .inertia = Inertia(1.0, Vec3{0, 0, 0})}));
  const Model model = must_build(builder.build());
  Random random(308);
  std::vector<State> states(4, State{{0.3, 0.5}, {0, 0}, {0, 0}, {0, 0}});
  ASSERT_TRUE((Pack<double, 4>(model, states, random).forward()));
  states[2].q[1] = 0.0;
  const auto done = Pack<double, 4>(model, states, random).forward();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::singular);
}

TEST(PackDerivatives, AreRefusedWhereAJointOfOnesOwnDoesNotSayItsDerivatives) {
  Random random(309);
  ModelBuilder builder;
  must_build(builder.add(
      {"own", kWorld, std::make_shared<ScrewsJoint<1>>(random, false), {}, random_body(random)}));
  const Model model = must_build(builder.build());
  Pack<double, 4> pack(model, states_of(random, model, 4), random);
  for (const auto& done : {pack.forward(), pack.inverse()}) {
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Errc::unsupported);
    EXPECT_NE(done.error().message.find("UserJoint::subspace_derivatives"), std::string::npos);
  }
}

}  // namespace
}  // namespace vp::test
