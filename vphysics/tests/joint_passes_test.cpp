// The passes over joints give the same bits with every number of lanes. Their rotations and angles
// match the functions of the standard library.
#include "solve/joint_passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

#include "random.h"
#include "solve/passes.h"
#include "world/free_rotation.h"

namespace vp::solve {
namespace {

constexpr std::uint32_t kHanging = 2 * kLanes;  // bodies; the last lanes of three blocks are empty
constexpr float kH = 1.0f / 540;

struct JointTables {
  const char* name;
  const AllJointPasses* passes;
};
std::vector<JointTables> tables_of_this_machine() {
  std::vector<JointTables> all = {{"baseline", &kBaselineJoints}};
#ifdef VP_INSTRUCTION_SETS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2")) all.push_back({"AVX2", &kAvx2Joints});
  if (&joint_passes() == &kAvx512Joints) all.push_back({"AVX-512", &kAvx512Joints});
#endif
  return all;
}

Vec3 random_axis(vp::test::Random& random) {
  const Vec3 u{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  return (1.0 / std::max(0.1, norm(u))) * u;
}

// Pairs of bodies, each joined in one lane of blocks of one form.
template <class B>
struct Pairs {
  std::vector<BodyState> states{2 * kHanging + 1};
  std::vector<solve::StartDisplacement> start{2 * kHanging};
  std::vector<std::uint32_t> bodies{std::vector<std::uint32_t>(2 * kHanging)};
  std::vector<StepMotion> motions{2 * kHanging + 1};
  std::vector<B> blocks{3};
  JointForm form;

  Pairs(const JointForm& of, std::uint64_t seed) : form(of) {
    vp::test::Random random(seed);
    const auto number = [&](double low, double high) {
      return static_cast<float>(random.uniform(low, high));
    };
    std::iota(bodies.begin(), bodies.end(), 0u);
    for (StepMotion& motion : motions) motion = {{0, 0, 0, 1}, {}, 0};
    for (const std::uint32_t body : bodies) {
      BodyState& state = states[body + 1];
      for (int k = 0; k < 6; ++k) state.velocity[k] = number(-1, 1);
      state.velocity[kInverseMass] = body % 9 == 0 ? 0.0f : number(0.5, 2.0);
      for (int k = 0; k < 3; ++k) state.inertia[k] = body % 9 == 0 ? 0.0f : number(4.0, 8.0);
      for (int k = 3; k < 6; ++k) state.inertia[k] = body % 9 == 0 ? 0.0f : number(-1.0, 1.0);
      for (int k = 0; k < 6; ++k) start[body].displacement[k] = number(-0.1, 0.1);
      for (int k = 0; k < 6; ++k) state.displacement[k] = number(-0.4, 0.4);
    }
    for (std::uint32_t pair = 0; pair < kHanging; ++pair) fill(pair, random);
  }
  // Arbitrary values, chosen so that all force laws act.
  void fill(std::uint32_t pair, vp::test::Random& random) {
    B& block = blocks[pair / kLanes];
    const int lane = static_cast<int>(pair % kLanes);
    // The third block has one lane in use.
    const bool last = pair == kHanging - 1;
    B& to = last ? blocks[2] : block;
    const int at = last ? 0 : lane;
    const auto put = [&](Field& field, double low, double high) {
      field.lane[at] = static_cast<float>(random.uniform(low, high));
    };
    const auto put3 = [&](Field3& field, double size) {
      for (Field* one : {&field.x, &field.y, &field.z}) put(*one, -size, size);
    };
    const auto put_axis = [&](Field3& field, const Vec3& u) {
      field.x.lane[at] = static_cast<float>(u.x);
      field.y.lane[at] = static_cast<float>(u.y);
      field.z.lane[at] = static_cast<float>(u.z);
    };
    to.a.lane[at] = 2 * pair + 1;
    to.b.lane[at] = 2 * pair + 2;
    to.joint.lane[at] = pair;
    const auto put_row = [&](auto& row) {
      put(row.rate, 10, 100);
      put(row.loss, 0.0, 0.1);
      row.relaxes.lane[at] = random.word() % 2 == 0 ? 1.0f : 0.0f;
    };
    if constexpr (B::kAxes) {
      put3(to.point.start_arm_a, 0.5);
      put3(to.point.start_arm_b, 0.5);
      put3(to.point.start_separation, 0.01);
      put3(to.point.impulse, 1.0);
      put_row(to.point);
    }
    if constexpr (B::kAxes && B::kOtherRows > 0) {
      const Mat3 R_a = Exp(random_axis(random)).matrix(),
                 R_b = Exp(2.0 * random_axis(random)).matrix() * R_a;
      put_axis(to.axes.a_x, R_a.cx);
      put_axis(to.axes.a_y, R_a.cy);
      put_axis(to.axes.b_x, R_b.cx);
      put_axis(to.axes.b_z, R_b.cz);
      put(to.axes.twist, -3, 3);
      put(to.axes.cone_x, 0.3, 1);
      put(to.axes.cone_y, 0.3, 1);
    }
    for (int i = 0; i < form.rows; ++i) {
      RowPart& row = to.rows[i];
      BoundPart& bound = to.bounds[i];
      put_row(row);
      put(row.residual, -0.2, 0.2);
      put(row.impulse, -1, 1);
      put(bound.stop, -1, 1);
      bound.holds.lane[at] = random.word() % 4 == 0 ? 1.0f : 0.0f;
      put(bound.min_impulse, -2, random.word() % 3 == 0 ? 0.0 : -1.0);
      put(bound.max_impulse, 0, 2);
      put(bound.stiffness, 0, random.word() % 3 == 0 ? 1e6 : 0.0);
      put(bound.damping, 0, 10);
      put(bound.position, -1, 1);
      put(bound.speed, -1, 1);
      put(bound.lower, -0.5, 0);
      bound.upper.lane[at] = random.word() % 2 == 0 ? kNoBound : 0.1f;
      if constexpr (!B::kAxes) {
        put3(to.jacobian[i].linear_a, 1);
        put3(to.jacobian[i].angular_a, 1);
        put3(to.jacobian[i].linear_b, 1);
        put3(to.jacobian[i].angular_b, 1);
      }
    }
  }
  void sub_step(const AllJointPasses& all, const JointPasses<B>& passes) {
    const typename JointPasses<B>::Run run{blocks.data(), blocks.size(), &form, states.data(),
                                           motions.data()};
    all.find_step_motions(states.data(), start.data(), bodies.data(), bodies.size(),
                          motions.data());
    passes.load_masses(run);
    passes.prepare(run);
    passes.warm_start(run);
    passes.solve_first(run, kH);
    passes.solve_again(run, kH);
    passes.solve_again(run, kH);
    passes.relax(run, kH);
  }
};

// Compares the used lanes. Passes may write into empty lanes, so those are not compared.
template <class B>
bool same_lanes(const std::vector<B>& some, const std::vector<B>& others) {
  for (std::size_t k = 0; k < some.size(); ++k) {
    const auto* const one = reinterpret_cast<const IndexField*>(&some[k]);
    const auto* const other = reinterpret_cast<const IndexField*>(&others[k]);
    for (std::size_t field = 0; field < sizeof(B) / sizeof(IndexField); ++field) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const bool used = some[k].b.lane[lane] != kWorldState;
        if (used && one[field].lane[lane] != other[field].lane[lane]) return false;
      }
    }
  }
  return true;
}

template <class B>
void expect_the_same_bits(const JointForm& form, JointPasses<B> AllJointPasses::*kind) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Pairs<B> first(form, seed);
    first.sub_step(kBaselineJoints, kBaselineJoints.*kind);
    for (const float x : first.states[5].velocity) ASSERT_TRUE(std::isfinite(x));
    for (const JointTables& table : tables_of_this_machine()) {
      Pairs<B> other(form, seed);
      other.sub_step(*table.passes, table.passes->*kind);
      EXPECT_TRUE(same_lanes(first.blocks, other.blocks)) << table.name << ' ' << seed;
      EXPECT_EQ(std::memcmp(first.states.data(), other.states.data(),
                            first.states.size() * sizeof(BodyState)),
                0)
          << table.name << ' ' << seed;
    }
  }
}

TEST(JointPasses, GiveTheSameBitsInEveryWidth) {
  expect_the_same_bits({}, &AllJointPasses::ball);
  expect_the_same_bits({2, 2, {kSwingX, kSwingY}}, &AllJointPasses::axes);          // hinge
  expect_the_same_bits({3, 3, {kSwingX, kSwingY, kTwist}}, &AllJointPasses::axes);  // weld
  expect_the_same_bits({3, 2, {kSwingX, kSwingY, kTwist}}, &AllJointPasses::axes);  // with limits
  expect_the_same_bits({2, 0, {kCone, kTwist}}, &AllJointPasses::axes);
  expect_the_same_bits({1, 0, {kTwist}}, &AllJointPasses::axes);
  expect_the_same_bits({5, 5, {0, 1, kSwingX, kSwingY, kTwist}}, &AllJointPasses::frames);
  expect_the_same_bits({6, 3, {0, kSwingX, kSwingY, 1, 2, kTwist}}, &AllJointPasses::frames);
  expect_the_same_bits({6, 3, {}}, &AllJointPasses::rows);
  expect_the_same_bits({1, 0, {}}, &AllJointPasses::rows);
}

// Bodies with random inertias and rates, some of which rotate far in a sub-step.
struct Spinning {
  static constexpr std::size_t kBodies = kLanes + 3;
  std::vector<BodyState> states{kBodies + 1};
  std::vector<solve::StartDisplacement> start{kBodies};
  std::vector<std::uint32_t> bodies{std::vector<std::uint32_t>(kBodies)};
  std::vector<BodyInertia> inertias{kBodies};
  std::vector<Sym3> exact{kBodies};  // the inertias

  explicit Spinning(std::uint64_t seed, double max_rate) {
    vp::test::Random random(seed);
    std::iota(bodies.begin(), bodies.end(), 0u);
    for (const std::uint32_t body : bodies) {
      const double a = random.uniform(0.2, 1), b = random.uniform(0.2, 1);
      const Sym3 diagonal{a, b, random.uniform(std::fabs(a - b), a + b), 0, 0, 0};
      exact[body] = rotated(Exp(2.0 * random_axis(random)).matrix(), diagonal);
      const auto put = [](float* out, const Sym3& I) {
        const double values[6] = {I.xx, I.yy, I.zz, I.xy, I.yz, I.zx};
        for (int k = 0; k < 6; ++k) out[k] = static_cast<float>(values[k]);
      };
      put(inertias[body].inertia, exact[body]);
      put(inertias[body].inverse, inverse(exact[body]));
      inertias[body].inverse[6] = 1.0f;
      const Vec3 w = random.uniform(0, max_rate) * random_axis(random);
      BodyState& state = states[body + 1];
      for (int k = 0; k < 8; ++k) state.inertia[k] = 7.0f;  // those of rotation are overwritten
      for (int k = 0; k < 3; ++k) state.velocity[k] = state.displacement[k] = 2.0f;
      for (int k = 0; k < 3; ++k) {
        const double rate = k == 0 ? w.x : k == 1 ? w.y : w.z;
        start[body].displacement[3 + k] = static_cast<float>(random.uniform(-0.2, 0.2));
        state.velocity[3 + k] = static_cast<float>(rate);
      }
    }
    move();
  }
  void move() {
    for (const std::uint32_t body : bodies) {
      BodyState& state = states[body + 1];
      for (int k = 3; k < 6; ++k)
        state.displacement[k] = start[body].displacement[k] + kH * state.velocity[k];
    }
  }
  void precess(const AllJointPasses& all) {
    all.precess(states.data(), start.data(), bodies.data(), bodies.size(), inertias.data(), kH);
  }
};
Vec3 vec_at(const float* p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

TEST(JointPasses, PrecessAsFreeBodies) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Spinning spinning(seed, 150.0);  // up to 0.28 rad in the sub-step: one part of free_rotation
    const std::vector<BodyState> before = spinning.states;
    spinning.precess(joint_passes());
    for (const std::uint32_t body : spinning.bodies) {
      const BodyState& state = spinning.states[body + 1];
      const Vec3 w = vec_at(before[body + 1].velocity + 3);
      const Sym3& I = spinning.exact[body];
      const FreeRotation exact = free_rotation(I, inverse(I), w, static_cast<double>(kH));
      const Mat3 R = from_quaternion(exact.q);
      const double size = 1e-6 + norm(w);
      EXPECT_LT(norm(vec_at(state.velocity + 3) - R * exact.w), 1e-5 * size) << seed;
      const Vec3 turned =
          vec_at(state.displacement + 3) - vec_at(spinning.start[body].displacement + 3);
      const Mat3 found = Exp(turned).matrix();
      EXPECT_LT(norm(found.cx - R.cx) + norm(found.cy - R.cy), 1e-5) << seed;
      const Vec3 momentum = I * w;
      const Vec3 after = found * (I * transposed_times(found, vec_at(state.velocity + 3)));
      EXPECT_LT(norm(after - momentum), 3e-6 * norm(momentum)) << seed;
      const Sym3 J = rotated(found, inverse(I));
      const double largest = J.xx + J.yy + J.zz;
      const float* const at = state.inertia;
      EXPECT_LT(norm(vec_at(at) - Vec3{J.xx, J.yy, J.zz}), 1e-5 * largest) << seed;
      EXPECT_LT(norm(vec_at(at + 3) - Vec3{J.xy, J.yz, J.zx}), 1e-5 * largest) << seed;
      for (int k = 0; k < 3; ++k) EXPECT_EQ(state.velocity[k], 2.0f);
      for (int k = 0; k < 3; ++k) EXPECT_EQ(state.displacement[k], 2.0f);
      for (int k = 6; k < 8; ++k) EXPECT_EQ(at[k], 7.0f);
    }
  }
}

TEST(JointPasses, PrecessToTheSameBitsInEveryWidth) {
  for (const double max_rate : {1.0, 100.0, 5000.0}) {
    Spinning first(7, max_rate);
    first.precess(kBaselineJoints);
    for (const JointTables& table : tables_of_this_machine()) {
      Spinning other(7, max_rate);
      other.precess(*table.passes);
      EXPECT_EQ(std::memcmp(first.states.data(), other.states.data(),
                            first.states.size() * sizeof(BodyState)),
                0)
          << table.name;
    }
  }
}

TEST(JointPasses, AnglesAreThoseOfTheStandardLibrary) {
  using F = Lanes<4>;
  double worst = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double angle = kPi * (i / 50'000.0 - 1.0), size = std::pow(10.0, i % 13 - 6);
    const float y = static_cast<float>(size * std::sin(angle)),
                x = static_cast<float>(size * std::cos(angle));
    const float found = angle_of<4>(F(y), F(x))[1];
    worst = std::max(worst, std::fabs(static_cast<double>(found) -
                                      std::atan2(static_cast<double>(y), static_cast<double>(x))));
  }
  EXPECT_LT(worst, 6e-7);
  EXPECT_EQ(angle_of<4>(F(0.0f), F(0.0f))[0], 0.0f);
}

TEST(JointPasses, TurnsAreThoseOfTheExponential) {
  using F = Lanes<4>;
  vp::test::Random random(3);
  for (int i = 0; i < 20'000; ++i) {
    const double size = i % 4 == 0 ? 0.0 : std::pow(10.0, i % 12 - 10.0);  // up to 10 rad
    const Vec3 theta = size * random_axis(random), u = random_axis(random);
    const Vec3T<F> t{F(static_cast<float>(theta.x)), F(static_cast<float>(theta.y)),
                     F(static_cast<float>(theta.z))};
    Vec3T<F> q;
    F w;
    quaternion_of<4>(t, q, w);
    const Vec3T<F> v{F(static_cast<float>(u.x)), F(static_cast<float>(u.y)),
                     F(static_cast<float>(u.z))};
    const Vec3T<F> less = rotated_minus(q, w, v);
    const Vec3 exact = Exp(theta).matrix() * u - u;
    const Vec3 found{static_cast<double>(less.x[2]), static_cast<double>(less.y[2]),
                     static_cast<double>(less.z[2])};
    EXPECT_LT(norm(found - exact), 1e-9 + 1e-6 * std::min(size, 4.0)) << size;
  }
}

}  // namespace
}  // namespace vp::solve
