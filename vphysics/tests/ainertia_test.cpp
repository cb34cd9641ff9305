// The articulated inertia against 6x6 matrices: equation (6) against equation (7).
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

#include "random.h"
#include "vphysics/lie.h"

namespace vp::test {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Vector6 dense(const se3& V) {
  return (Vector6() << V.w.x, V.w.y, V.w.z, V.v.x, V.v.y, V.v.z).finished();
}
Vector6 dense(const dse3& F) {
  return (Vector6() << F.m.x, F.m.y, F.m.z, F.f.x, F.f.y, F.f.z).finished();
}
se3 unit(int i) {
  se3 V;
  (i < 3 ? V.w : V.v)[i % 3] = 1.0;
  return V;
}
template <class J>
Matrix6 dense(const J& inertia) {
  Matrix6 out;
  for (int i = 0; i < 6; ++i) out.col(i) = dense(inertia * unit(i));
  return out;
}
Matrix6 spatial_transform(const SE3& A) {
  Eigen::Matrix3d R, p;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) R(r, c) = A.rotation()(r, c);
  }
  const Vec3& x = A.position();
  p << 0, -x.z, x.y, x.z, 0, -x.x, -x.y, x.x, 0;
  Matrix6 X = Matrix6::Zero();
  X.topLeftCorner<3, 3>() = X.bottomRightCorner<3, 3>() = R;
  X.bottomLeftCorner<3, 3>() = p * R;
  return X;
}
se3 random_twist(Random& random) {
  return {random.in_cube(1), random.in_cube(1)};
}
Inertia random_inertia(Random& random) {
  return Inertia(random.uniform(0.5, 3), Vec3{1, 2, 1.5}).Xform(random.pose(1));
}
// A general articulated inertia: that of a body with another body hanging on it.
AInertia random_articulated(Random& random) {
  const AInertia J = random_inertia(random);
  const dse3 eta = J * random_twist(random);
  return J + 0.3 * (eta * eta) + random_inertia(random);
}

// The line of the paper's Table 2, verbatim, against equation (7) in matrices.
TEST(EquationSix, AsTableTwoWritesItIsEquationSeven) {
  Random random(31);
  constexpr int n = 2;
  for (int round = 0; round < 500; ++round) {
    SE3 f[n];
    Inertia I[n];
    AInertia J[n];
    se3 S[n];
    dse3 eta;
    f[1] = random.pose(1);
    I[0] = random_inertia(random);
    J[1] = random_articulated(random);
    S[1] = random_twist(random);
    const int i = 1;

    eta = J[i] * S[i];
    // clang-format off
    J[i-1] = I[i-1]
    + (J[i] - (eta*eta) / (S[i]*eta)) .Xform(Inv(f[i]));
    // clang-format on

    const Matrix6 IA = dense(J[1]), X = spatial_transform(f[1]).inverse();
    const Vector6 s = dense(S[1]);
    const Matrix6 expected =
        dense(I[0]) +
        X.transpose() * (IA - IA * s * s.transpose() * IA / (s.transpose() * IA * s)) * X;
    ASSERT_LT((dense(J[0]) - expected).cwiseAbs().maxCoeff(), 2e-13) << round;
  }
}

TEST(AInertia, OfARigidBodyIsItsInertia) {
  Random random(32);
  for (int i = 0; i < 200; ++i) {
    const Inertia J = random_inertia(random), K = random_inertia(random);
    const AInertia L = random_articulated(random);
    EXPECT_EQ(dense(AInertia(J)), dense(J));
    EXPECT_LT((dense(J + L) - dense(J) - dense(L)).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((dense(L / 4.0) * 4.0 - dense(L)).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((dense(AInertia(J + K)) - dense(J) - dense(K)).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(AInertia, IsSymmetricAndSeenFromAnotherFrameACongruence) {
  Random random(33);
  for (int i = 0; i < 500; ++i) {
    const AInertia J = random_articulated(random);
    const SE3 A = random.pose(2);
    const Matrix6 M = dense(J), X = spatial_transform(A);
    ASSERT_LT((M - M.transpose()).cwiseAbs().maxCoeff(), 1e-300);
    ASSERT_LT((dense(J.Xform(A)) - X.transpose() * M * X).cwiseAbs().maxCoeff(), 3e-13);
  }
}

TEST(AInertia, ProductOfTwoForcesIsTheSymmetricPart) {
  Random random(34);
  for (int i = 0; i < 200; ++i) {
    const dse3 a{random.in_cube(1), random.in_cube(1)}, b{random.in_cube(1), random.in_cube(1)};
    const Matrix6 ab = dense(a) * dense(b).transpose();
    EXPECT_LT((dense(a * b) - 0.5 * (ab + ab.transpose())).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((dense(outer(3.0, a)) - 3.0 * dense(a) * dense(a).transpose()).cwiseAbs().maxCoeff(),
              1e-15);
  }
}

}  // namespace
}  // namespace vp::test
