// The Lie groups against long double and against their definitions.
#include "vphysics/lie.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "largest.h"
#include "random.h"

namespace vp::test {
namespace {

double difference(const SE3& A, const SE3& B) {
  const Mat3 &R = A.rotation(), &S = B.rotation();
  return std::max({largest(R.cx - S.cx), largest(R.cy - S.cy), largest(R.cz - S.cz),
                   largest(A.position() - B.position())});
}
double not_orthonormal(const Mat3& R) {
  return std::max({std::fabs(dot(R.cx, R.cx) - 1), std::fabs(dot(R.cy, R.cy) - 1),
                   std::fabs(dot(R.cx, R.cy)), largest(cross(R.cx, R.cy) - R.cz)});
}

// Exp by its power series in long double, with scaling and squaring: an independent route.
using LongSE3 = SE3T<long double>;
LongSE3 exp_by_squaring(const se3& V) {
  constexpr int kHalvings = 12;
  const long double s = 1.0L / (1 << kHalvings);
  const Vec3T<long double> w{s * V.w.x, s * V.w.y, s * V.w.z};
  const Vec3T<long double> v{s * V.v.x, s * V.v.y, s * V.v.z};
  // Columns of sum [w]^k / k! and of sum [w]^k / (k+1)! applied to v.
  const auto series = [&](Vec3T<long double> a, int first) {
    Vec3T<long double> sum = a;
    long double factorial = 1.0L;
    for (int k = 1; k < 16; ++k) {
      a = cross(w, a);
      factorial *= static_cast<long double>(k + first);
      sum += (1.0L / factorial) * a;
    }
    return sum;
  };
  LongSE3 T({series({1, 0, 0}, 0), series({0, 1, 0}, 0), series({0, 0, 1}, 0)}, series(v, 1));
  for (int i = 0; i < kHalvings; ++i) T = T * T;
  return T;
}
SE3 rounded(const LongSE3& T) {
  const auto to = [](const Vec3T<long double>& a) {
    return Vec3{static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
  };
  const auto& R = T.rotation();
  return {{to(R.cx), to(R.cy), to(R.cz)}, to(T.position())};
}

// Measured: sine 1.1e-16, cosine 1.2e-16.
TEST(Scalar, SineAndCosineAreWithinTwoUlpOfLongDouble) {
  Random random(1);
  for (int i = 0; i < 300000; ++i) {
    const double x = i < 200000 ? random.uniform(-10, 10) : random.uniform(-1e6, 1e6);
    const auto [s, c] = sin_cos(x);
    ASSERT_NEAR(s, static_cast<double>(std::sin(static_cast<long double>(x))), 2.3e-16) << x;
    ASSERT_NEAR(c, static_cast<double>(std::cos(static_cast<long double>(x))), 2.3e-16) << x;
  }
  EXPECT_EQ(sin_cos(0.0).sin, 0.0);
  EXPECT_EQ(sin_cos(0.0).cos, 1.0);
}

TEST(Scalar, HugeAnglesStayOnTheCircle) {
  for (const double x : {1e7, -1e9, 1e15, 1e300, -1.7e308}) {
    const auto [s, c] = sin_cos(x);
    EXPECT_NEAR(s * s + c * c, 1.0, 4e-16) << x;
  }
}

// Measured 4.4e-16, in the third and fourth quadrant.
TEST(Scalar, ArcTangentAgreesWithLongDoubleInEveryQuadrant) {
  Random random(2);
  for (int i = 0; i < 200000; ++i) {
    const double y = random.uniform(-2, 2), x = random.uniform(-2, 2);
    const auto exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    ASSERT_NEAR(arc_tangent(y, x), static_cast<double>(exact), 4.5e-16) << y << ' ' << x;
  }
  EXPECT_EQ(arc_tangent(0.0, 0.0), 0.0);
  EXPECT_EQ(arc_tangent(0.0, 1.0), 0.0);
  EXPECT_EQ(arc_tangent(0.0, -1.0), kPi);
  EXPECT_EQ(arc_tangent(1.0, 0.0), 0.5 * kPi);
  EXPECT_EQ(arc_tangent(-1.0, 0.0), -0.5 * kPi);
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(arc_tangent(kNoNumber, 1.0)));
  EXPECT_TRUE(std::isnan(arc_tangent(1.0, kNoNumber)));
}

// Angles where a branch or the conditioning changes: both sides of each threshold, tiny angles,
// near and at half a revolution, and beyond.
const double kAngles[] = {0.0,        1e-300,     1e-160, 1e-12, 1e-8,       1e-4,
                          0.31622776,  // sqrt of kLogSeriesBelow
                          0.31622777,
                          0.49999999,  // sqrt of kExpSeriesBelow
                          0.50000001, 0.78539816, 1.5,    3.0,   kPi - 1e-4, kPi - 1e-8,
                          kPi - 1e-12};

// The coefficients of Exp and Log by their power series in long double. Fewer than 40 terms reach
// its last bit up to half a revolution, where the largest term is 12 and cancels 4 bits.
struct LongCoefficients {
  explicit LongCoefficients(long double t) {
    long double power = 1.0L, factorial = 1.0L;  // t^k, (2k)!
    long double numerator = 0.0L, slope = 0.0L;  // (2 B - A) / t = 2 B D, and its derivative
    for (int k = 0; k < 40; ++k) {
      const long double odd = factorial * (2 * k + 1), even = odd * (2 * k + 2),
                        next = even * (2 * k + 3), sign = k % 2 == 0 ? 1.0L : -1.0L;
      A += sign * power / odd;
      B += sign * power / even;
      C += sign * power / next;
      const long double term = sign * (2.0L / even - 1.0L / odd);  // of 2 B - A
      if (k > 0) numerator += (power / t) * term;
      if (k > 1) slope += (k - 1) * (power / t / t) * term;
      if (k > 0) B1 += sign * k * (power / t) / even, C1 += sign * k * (power / t) / next;
      power *= t;
      factorial = even;
    }
    D = numerator / (2 * B);
    D1 = (slope - 2 * B1 * D) / (2 * B);
  }
  long double A = 0, B = 0, C = 0, D = 0, B1 = 0, C1 = 0, D1 = 0;
};

// Each error is weighted by the factor that the coefficient has where it is used: t^(n/2) for a
// term with n factors w. Measured: A 2.0e-16, B t^(1/2) 3.1e-16, C t 2.1e-16, D t 3.3e-16, B' t
// 1.6e-16, C' t^(3/2) 4.8e-16, D' t^(3/2) 6.7e-16.
TEST(Coefficients, HoldOnBothSidesOfTheirSwitchingPoints) {
  double worst[7] = {};
  const double switching[] = {detail::kExpSeriesBelow, detail::kLogSeriesBelow};
  std::vector<double> squares;
  for (const double t : switching) {
    squares.insert(squares.end(), {t, std::nextafter(t, 0.0), 0.99 * t, 1.01 * t, 0.5 * t, 2 * t});
  }
  for (int i = 1; i <= 4000; ++i) squares.push_back(kPi * kPi * i / 4000.0);
  for (int i = 0; i < 60; ++i) squares.push_back(std::pow(10.0, -i));
  for (const double square : squares) {
    const double theta = std::sqrt(square);
    const Vec3 w{theta, 0, 0};
    const auto k = detail::exp_coefficients(w);
    const LongCoefficients exact(static_cast<long double>(k.t));
    const double C = detail::coefficient_C(k), D = detail::coefficient_D(k), t = k.t;
    const auto off = [](double got, long double wanted) {
      return static_cast<double>(std::fabs(static_cast<long double>(got) - wanted));
    };
    const double error[7] = {off(k.A, exact.A),
                             theta * off(k.B, exact.B),
                             t * off(C, exact.C),
                             t * off(D, exact.D),
                             t * off(detail::derivative_B(k), exact.B1),
                             t * theta * off(detail::derivative_C(k, C), exact.C1),
                             t * theta * off(detail::derivative_D(k, D), exact.D1)};
    for (int i = 0; i < 7; ++i) worst[i] = std::max(worst[i], error[i]);
  }
  const double bounds[7] = {2.3e-16, 3.4e-16, 2.3e-16, 4.5e-16, 2.3e-16, 5.6e-16, 7.8e-16};
  for (int i = 0; i < 7; ++i) EXPECT_LT(worst[i], bounds[i]) << "coefficient " << i;
}

TEST(Exp, OfZeroIsIdentity) {
  EXPECT_EQ(Exp(se3{}), SE3{});
}

TEST(Exp, AgreesWithItsSeriesAtEveryBranch) {
  Random random(3);
  for (const double angle : kAngles) {
    for (int i = 0; i < 200; ++i) {
      const se3 V{angle * random.direction(), random.in_cube(2.0)};
      const SE3 T = Exp(V);
      ASSERT_LT(difference(T, rounded(exp_by_squaring(V))), 2e-15) << angle;
      ASSERT_LT(not_orthonormal(T.rotation()), 2e-15) << angle;
    }
  }
}

TEST(Log, InvertsExpAtEveryBranch) {
  Random random(4);
  for (const double angle : kAngles) {
    for (int i = 0; i < 500; ++i) {
      const se3 V{angle * random.direction(), random.in_cube(2.0)};
      const se3 L = Log(Exp(V));
      // Rounding of a rotation matrix changes its angle by about 1e-16 over the sine of half the
      // angle.
      ASSERT_LT(largest(L.w - V.w), 2e-15) << angle;
      ASSERT_LT(largest(L.v - V.v), 1e-14) << angle;
    }
  }
}

TEST(Log, OfAHalfTurnExponentiatesBack) {
  Random random(5);
  const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0.6, 0.8, 0}, {0, -0.6, 0.8}};
  for (const Vec3& axis : axes) {
    const SE3 T = Exp(se3{kPi * axis, random.in_cube(1.0)});
    EXPECT_LT(difference(Exp(Log(T)), T), 3e-15);
    EXPECT_NEAR(norm(Log(T).w), kPi, 1e-15);
  }
  const SE3 flip({{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, {1, 2, 3});
  EXPECT_LT(difference(Exp(Log(flip)), flip), 3e-15);
}

TEST(Log, OfRandomPosesExponentiatesBack) {
  Random random(6);
  for (int i = 0; i < 20000; ++i) {
    const SE3 T = random.pose(3.0);
    ASSERT_LT(difference(Exp(Log(T)), T), 5e-15);
  }
}

TEST(SE3, IsAGroup) {
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const SE3 A = random.pose(2), B = random.pose(2), C = random.pose(2);
    ASSERT_LT(difference(A * Inv(A), SE3{}), 6e-15);
    ASSERT_LT(difference((A * B) * C, A * (B * C)), 5e-15);
    const Vec3 x = random.in_cube(1);
    ASSERT_LT(largest((A * B) * x - A * (B * x)), 3e-15);
    ASSERT_LT(largest(inverse_times(A, x) - Inv(A) * x), 3e-15);
  }
}

TEST(Ad, IsTheConjugationOfExp) {
  Random random(8);
  for (int i = 0; i < 2000; ++i) {
    const SE3 A = random.pose(1);
    const se3 V{random.in_cube(1), random.in_cube(1)};
    ASSERT_LT(difference(Exp(Ad(A, V)), A * Exp(V) * Inv(A)), 5e-15);
  }
}

TEST(SO3, IsAGroupThatTurnsTheAxesOfItsAlgebra) {
  Random random(14);
  for (int i = 0; i < 2000; ++i) {
    const SO3 A(random.rotation()), B(random.rotation());
    const Vec3 x = random.in_cube(1);
    ASSERT_LT(largest((A * B) * x - A * (B * x)), 3e-15);
    ASSERT_LT(largest(Inv(A) * (A * x) - x), 3e-15);
    ASSERT_LT(difference(SE3(Exp(Ad(A, x)), {}), SE3(A * Exp(x) * Inv(A), {})), 5e-15);
    ASSERT_LT(difference(SE3(Exp(Log(A)), {}), SE3(A, {})), 5e-15);
    ASSERT_LT(largest(Ad(A * B, x) - Ad(A, Ad(B, x))), 3e-15);
  }
}

template <class A, class B>
concept Addable = requires(A a, B b) {
  a + b;
};
template <class A, class B>
concept Subtractable = requires(A a, B b) {
  a - b;
};

// Section 4.3: the types have only their group's operators; a velocity and a force have no sum.
TEST(Types, HaveNoOperatorThatTheirGroupHasNot) {
  static_assert(!Addable<SE3, SE3> && !Subtractable<SE3, SE3> && !Addable<SO3, SO3> &&
                !Subtractable<SO3, SO3> && !Addable<SE3, se3> && !Addable<se3, dse3> &&
                !Addable<dse3, Inertia> && !Subtractable<Inertia, Inertia>);
  static_assert(Addable<se3, se3> && Addable<dse3, dse3> && Addable<Inertia, AInertia>);
  static_assert(!std::is_convertible_v<Mat3, SO3> && !std::is_convertible_v<AInertia, Inertia> &&
                std::is_convertible_v<Inertia, AInertia>);
  static_assert(sizeof(SO3) == 9 * sizeof(double) && sizeof(SE3T<float>) == 12 * sizeof(float));
}

TEST(Interpolate, TurnsAndMovesAtAConstantRateFromOneToTheOther) {
  Random random(15);
  for (int i = 0; i < 500; ++i) {
    const SE3 A = random.pose(1), B = random.pose(1);
    ASSERT_LT(difference(interpolate(A, B, 0.0), A), 1e-15);
    ASSERT_LT(difference(interpolate(A, B, 1.0), B), 1e-14);
    const SE3 quarter = interpolate(A, B, 0.25), half = interpolate(A, B, 0.5);
    ASSERT_LT(difference(interpolate(A, half, 0.5), quarter), 1e-14);
    // The same screw motion in any frame.
    const SE3 C = random.pose(1);
    ASSERT_LT(difference(interpolate(C * A, C * B, 0.25), C * quarter), 2e-14);
    ASSERT_LT(difference(interpolate(B, A, 0.75), quarter), 5e-14);
    const SO3 R(A.rotation()), S(B.rotation());
    ASSERT_LT(difference(SE3(interpolate(R, S, 0.25), {}), SE3(quarter.rotation(), {})), 1e-15);
  }
}

TEST(Ad, OfTheInverseIsTheInverse) {
  Random random(16);
  for (int i = 0; i < 2000; ++i) {
    const SE3 A = random.pose(1);
    const se3 V{random.in_cube(1), random.in_cube(1)};
    const dse3 F{random.in_cube(1), random.in_cube(1)};
    const se3 a = InvAd(A, V), b = Ad(Inv(A), V);
    const dse3 c = InvdAd(A, F), d = dAd(Inv(A), F);
    ASSERT_LT(largest(a.w - b.w) + largest(a.v - b.v), 8e-15);
    ASSERT_LT(largest(c.m - d.m) + largest(c.f - d.f), 8e-15);
    ASSERT_LT(largest(InvAd(A, Ad(A, V)).v - V.v), 8e-15);
    ASSERT_NEAR(InvAd(A, V) * F, V * InvdAd(A, F), 8e-15);
  }
}

TEST(Ad, DualsKeepThePower) {
  Random random(9);
  for (int i = 0; i < 2000; ++i) {
    const SE3 A = random.pose(1);
    const se3 V{random.in_cube(1), random.in_cube(1)}, W{random.in_cube(1), random.in_cube(1)};
    const dse3 F{random.in_cube(1), random.in_cube(1)};
    ASSERT_NEAR(Ad(A, V) * F, V * dAd(A, F), 4e-15);
    ASSERT_NEAR(ad(V, W) * F, W * dad(V, F), 4e-15);
  }
}

TEST(Ad, LittleAdIsItsDerivative) {
  Random random(10);
  for (int i = 0; i < 200; ++i) {
    const se3 V{random.in_cube(1), random.in_cube(1)}, W{random.in_cube(1), random.in_cube(1)};
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const double e = k == 0 ? 1e-3 : 5e-4;
      const se3 slope = (0.5 / e) * (Ad(Exp(e * V), W) - Ad(Exp(-e * V), W));
      error[k] = std::max(largest(slope.w - ad(V, W).w), largest(slope.v - ad(V, W).v));
    }
    // Central differences: half the step gives a quarter of the error.
    ASSERT_NEAR(error[0] / error[1], 4.0, 0.05);
  }
}

TEST(Inertia, OfAMovedFrameHasTheSameEnergy) {
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const Inertia J = Inertia(random.uniform(0.5, 3), Vec3{1, 2, 1.5}).Xform(random.pose(1));
    const SE3 T = random.pose(1);
    const se3 V{random.in_cube(1), random.in_cube(1)};
    const double expected = Ad(T, V) * (J * Ad(T, V));
    ASSERT_NEAR(V * (J.Xform(T) * V), expected, 1e-14 * (1 + expected));
  }
}

TEST(Inertia, KnowsItsCentreAndCentralPart) {
  const Inertia at_centre(2.0, Vec3{1, 2, 3});
  const Inertia J = at_centre.Xform(SE3(Vec3{-0.5, 1, 2}));  // in a frame displaced by that vector
  EXPECT_LT(largest(J.centre_of_mass() - Vec3{0.5, -1, -2}), 1e-15);
  const Sym3 I = J.central();
  EXPECT_NEAR(I.xx, 1.0, 1e-14);
  EXPECT_NEAR(I.yy, 2.0, 1e-14);
  EXPECT_NEAR(I.zz, 3.0, 1e-14);
  EXPECT_NEAR(I.xy, 0.0, 1e-14);
}

TEST(Quaternion, RoundTripsAtEveryBranch) {
  Random random(12);
  for (int i = 0; i < 20000; ++i) {
    const Mat3 R = random.rotation();
    const Quaternion q = to_quaternion(R);
    ASSERT_GE(q.w, 0.0);
    ASSERT_LT(difference(SE3(from_quaternion(q), {}), SE3(R, {})), 3e-15);
  }
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Mat3 R = Exp(kPi * axis).matrix();
    ASSERT_LT(difference(SE3(from_quaternion(to_quaternion(R)), {}), SE3(R, {})), 3e-15);
  }
}

TEST(Orthonormalized, SquaresTheError) {
  Random random(13);
  for (int i = 0; i < 1000; ++i) {
    Mat3 R = random.rotation();
    R.cx += 1e-5 * random.in_cube(1);
    R.cz += 1e-5 * random.in_cube(1);
    ASSERT_LT(not_orthonormal(orthonormalized(R)), 1e-9);
  }
}

}  // namespace
}  // namespace vp::test
