// The Lie groups with their other scalars: dual numbers, packs, float, and the counting scalar.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "largest.h"
#include "operation_counts.h"
#include "random.h"
#include "vphysics/lie.h"
#include "vphysics/lie/count.h"
#include "vphysics/lie/dual.h"
#include "vphysics/lie/pack.h"

namespace vp::test {
namespace {

template <class T>
Vec3T<T> cast(const Vec3& a) {
  return {T(a.x), T(a.y), T(a.z)};
}
template <class T>
se3T<T> cast(const se3& V) {
  return {cast<T>(V.w), cast<T>(V.v)};
}
template <class T>
dse3T<T> cast(const dse3& F) {
  return {cast<T>(F.m), cast<T>(F.f)};
}
template <class T>
SE3T<T> cast(const SE3& A) {
  const Mat3& R = A.rotation();
  return {Mat3T<T>{cast<T>(R.cx), cast<T>(R.cy), cast<T>(R.cz)}, cast<T>(A.position())};
}
se3 random_twist(Random& random, double angle) {
  return {angle * random.direction(), random.in_cube(2.0)};
}

// Angles on both sides of every threshold, tiny, and near half a revolution.
const double kTwistAngles[] = {0.0,   1e-200, 1e-9, 1e-4, 0.31, 0.32,
                               0.499, 0.501,  1.0,  2.0,  3.0,  3.1415};

// --- dual numbers

using Dual = DualT<double>;

Vec3 value(const Vec3T<Dual>& a) {
  return {a.x.value, a.y.value, a.z.value};
}
Vec3 slope(const Vec3T<Dual>& a) {
  return {a.x.derivative[0], a.y.derivative[0], a.z.derivative[0]};
}
Vec3T<Dual> along(const Vec3& a, const Vec3& d) {
  Vec3T<Dual> out = cast<Dual>(a);
  for (int i = 0; i < 3; ++i) out[i].derivative[0] = d[i];
  return out;
}
se3T<Dual> along(const se3& V, const se3& d) {
  return {along(V.w, d.w), along(V.v, d.v)};
}
// The spatial velocity (in the fixed frame) of a moving pose.
se3 velocity(const SE3T<Dual>& A) {
  const Vec3 x = value(A.rotation().cx), y = value(A.rotation().cy), z = value(A.rotation().cz);
  const Vec3 dx = slope(A.rotation().cx), dy = slope(A.rotation().cy), dz = slope(A.rotation().cz);
  // R' R^T = [w], and w = sum of c x c' / 2 over the columns c
  const Vec3 w = 0.5 * (cross(x, dx) + cross(y, dy) + cross(z, dz));
  return {w, slope(A.position()) - cross(w, value(A.position()))};
}

TEST(Dual, KnowsTheSlopesOfArithmetic) {
  const Dual x = Dual::variable(0.7);
  EXPECT_NEAR((x * x * x).derivative[0], 3 * 0.49, 1e-15);
  EXPECT_NEAR((Dual(1) / x).derivative[0], -1 / 0.49, 1e-15);
  EXPECT_NEAR((-x - Dual(2) * x).derivative[0], -3, 1e-15);
  EXPECT_NEAR(sqrt(x).derivative[0], 0.5 / std::sqrt(0.7), 1e-15);
  EXPECT_NEAR(sin_cos(x).sin.derivative[0], std::cos(0.7), 1e-15);
  EXPECT_NEAR(sin_cos(x).cos.derivative[0], -std::sin(0.7), 1e-15);
  EXPECT_NEAR(arc_tangent(x, Dual(2)).derivative[0], 2 / (4 + 0.49), 1e-15);
}

// Measured: 9e-15, and 1.2e-14 at half a revolution.
TEST(Jacobian, IsTheSlopeOfExp) {
  Random random(21);
  for (const double angle : kTwistAngles) {
    for (int i = 0; i < 100; ++i) {
      const se3 V = random_twist(random, angle), d = random_twist(random, 1.0);
      const SE3T<Dual> moving = Exp(along(V, d));
      const se3 left = velocity(moving), expected = left_jacobian(V) * d;
      ASSERT_LT(largest(left.w - expected.w), 2e-14) << angle;
      ASSERT_LT(largest(left.v - expected.v), 2e-14) << angle;
      const se3 right = InvAd(Exp(V), left), expected_right = right_jacobian(V) * d;
      ASSERT_LT(largest(right.w - expected_right.w), 2e-14) << angle;
      ASSERT_LT(largest(right.v - expected_right.v), 2e-14) << angle;
      ASSERT_LT(largest(left_jacobian(V.w) * d.w - expected.w), 1e-15) << angle;
      ASSERT_LT(largest(right_jacobian(V.w) * d.w - expected_right.w), 1e-15) << angle;
    }
  }
}

TEST(Jacobian, OfLogIsTheInverse) {
  Random random(22);
  for (const double angle : kTwistAngles) {
    for (int i = 0; i < 100; ++i) {
      const se3 V = random_twist(random, angle), d = random_twist(random, 1.0);
      const SE3T<Dual> moving = Exp(along({}, d)) * Exp(cast<Dual>(V));
      const se3T<Dual> L = Log(moving);
      const se3 expected = left_jacobian_inverse(V) * d;
      ASSERT_LT(largest(slope(L.w) - expected.w), 1e-13) << angle;
      ASSERT_LT(largest(slope(L.v) - expected.v), 1e-13) << angle;
      const se3 back = left_jacobian(V) * expected,
                other = right_jacobian(V) * (right_jacobian_inverse(V) * d);
      ASSERT_LT(largest(back.w - d.w) + largest(back.v - d.v), 3e-14) << angle;
      ASSERT_LT(largest(other.w - d.w) + largest(other.v - d.v), 3e-14) << angle;
      ASSERT_LT(largest(left_jacobian_inverse(V.w) * d.w - expected.w), 1e-15) << angle;
    }
  }
}

TEST(Jacobian, TransposedTakesForces) {
  Random random(23);
  for (int i = 0; i < 200; ++i) {
    const se3 V = random_twist(random, 2.0), d = random_twist(random, 1.0);
    const dse3 F{random.in_cube(1), random.in_cube(1)};
    const SE3Jacobian J = left_jacobian(V);
    ASSERT_NEAR((J * d) * F, d * J.transposed_times(F), 2e-14);
  }
}

// --- packs

using Pack4 = PackT<double, 4>;

template <class T, int N>
void expect_lane(const PackT<T, N>& pack, int lane, T expected) {
  EXPECT_EQ(pack[lane], expected) << "lane " << lane;
}
template <class T, int N>
void expect_lane(const Vec3T<PackT<T, N>>& pack, int lane, const Vec3T<T>& expected) {
  for (int i = 0; i < 3; ++i) expect_lane(pack[i], lane, expected[i]);
}
template <class T, int N>
void expect_lane(const SE3T<PackT<T, N>>& pack, int lane, const SE3T<T>& expected) {
  expect_lane(pack.rotation().cx, lane, expected.rotation().cx);
  expect_lane(pack.rotation().cy, lane, expected.rotation().cy);
  expect_lane(pack.rotation().cz, lane, expected.rotation().cz);
  expect_lane(pack.position(), lane, expected.position());
}

template <class T, int N>
void lanes_are_scalars() {
  using P = PackT<T, N>;
  Random random(24);
  for (int round = 0; round < 300; ++round) {
    se3T<T> V[N];
    se3T<P> packed;
    for (int lane = 0; lane < N; ++lane) {
      // Sometimes all lanes on one side of a threshold, mostly on both.
      const int which = round % 3 == 0 ? round / 3 : round + lane * 5;
      V[lane] = cast<T>(random_twist(random, kTwistAngles[which % 12]));
      for (int i = 0; i < 3; ++i) {
        packed.w[i].set(lane, V[lane].w[i]);
        packed.v[i].set(lane, V[lane].v[i]);
      }
    }
    const SE3T<P> A = Exp(packed);
    const se3T<P> L = Log(A), W = left_jacobian_inverse(packed) * packed;
    for (int lane = 0; lane < N; ++lane) {
      const SE3T<T> alone = Exp(V[lane]);
      expect_lane(A, lane, alone);
      expect_lane(L.w, lane, Log(alone).w);
      expect_lane(L.v, lane, Log(alone).v);
      const se3T<T> w = left_jacobian_inverse(V[lane]) * V[lane];
      expect_lane(W.w, lane, w.w);
      expect_lane(W.v, lane, w.v);
    }
    ASSERT_FALSE(testing::Test::HasFailure()) << "round " << round;
  }
}

TEST(Pack, GivesEachLaneTheBitsOfTheScalar) {
  lanes_are_scalars<double, 4>();
  lanes_are_scalars<double, 8>();
  lanes_are_scalars<float, 16>();
}

TEST(Pack, HasHugeAnglesInSomeLanes) {
  Pack4 x(0.5);
  x.set(2, -1e9);
  const auto [s, c] = sin_cos(x);
  EXPECT_EQ(s[0], sin_cos(0.5).sin);
  EXPECT_EQ(s[2], sin_cos(-1e9).sin);
  EXPECT_EQ(c[2], sin_cos(-1e9).cos);
}

// --- float

// Measured: 6.0e-8.
TEST(Float, SineAndCosineAreWithinTwoUlp) {
  Random random(25);
  for (int i = 0; i < 200000; ++i) {
    const auto x = static_cast<float>(random.uniform(-4000, 4000));
    const auto [s, c] = sin_cos(x);
    ASSERT_NEAR(s, std::sin(static_cast<double>(x)), 1.2e-7) << x;
    ASSERT_NEAR(c, std::cos(static_cast<double>(x)), 1.2e-7) << x;
  }
}

TEST(Float, LogInvertsExp) {
  Random random(26);
  for (const double angle : kTwistAngles) {
    if (angle > 3.0) continue;  // rounding takes 3.1415 past half a revolution
    for (int i = 0; i < 100; ++i) {
      const se3T<float> V = cast<float>(random_twist(random, angle)), L = Log(Exp(V));
      for (int k = 0; k < 3; ++k) {
        ASSERT_NEAR(L.w[k], V.w[k], 2e-6f) << angle;
        ASSERT_NEAR(L.v[k], V.v[k], 1e-5f) << angle;
      }
    }
  }
}

// --- the paper's Table 3, and equation (6)

TEST(Table3, IsReachedOrBetterAndEquationSixToo) {
  const auto rows = count_operations_of_the_paper();
  ASSERT_EQ(rows.size(), 6u);
  for (const OperationRow& row : rows) {
    std::printf("%-16s %4ld x %4ld +   paper %4ld x %4ld +\n", row.name, row.multiplications(),
                row.ours.additions, row.paper_multiplications, row.paper_additions);
    EXPECT_LE(row.multiplications(), row.paper_multiplications) << row.name;
    EXPECT_LE(row.ours.additions, row.paper_additions) << row.name;
    EXPECT_GT(row.ours.multiplications, 0) << row.name;
    EXPECT_EQ(row.ours.others, 0) << row.name;
  }
}

}  // namespace
}  // namespace vp::test
