// Responses to impulses against dense matrices: J by difference quotients of poses, M inverted by
// Eigen.
#include "vphysics/multibody/impulse.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "trees.h"

namespace vp::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Numbers = std::vector<double>;

// The Jacobian of a link in its own frame: its columns are the link's velocity for each unit
// velocity.
Matrix link_jacobian(const Model& model, const Numbers& q, int link) {
  Data data(model);
  Matrix J(6, model.velocities());
  for (int k = 0; k < model.velocities(); ++k) {
    Numbers v(static_cast<std::size_t>(model.velocities()));
    v[static_cast<std::size_t>(k)] = 1.0;
    forward_kinematics<double>(model, data, q, v);
    const se3 V = link_velocity<double>(model, data, link);
    J.col(k) << V.w.x, V.w.y, V.w.z, V.v.x, V.v.y, V.v.z;
  }
  return J;
}

Matrix dense_mass(const Model& model, const Numbers& q) {
  Data data(model);
  const auto n = model.velocities();
  Numbers M(static_cast<std::size_t>(n * n));
  mass_matrix<double>(model, data, q, M);
  return Eigen::Map<Matrix>(M.data(), n, n);
}

Matrix dense(const Response& response) {
  Matrix L(6, 6);
  for (int k = 0; k < 6; ++k) {
    const se3& V = response.columns[static_cast<std::size_t>(k)];
    L.col(k) << V.w.x, V.w.y, V.w.z, V.v.x, V.v.y, V.v.z;
  }
  return L;
}

// Every pair of links: with a common ancestor, on one path, and of different roots.
TEST(InverseInertia, IsThatOfTheDenseMatrices) {
  Random random(71);
  double worst = 0.0;
  for (int round = 0; round < 20; ++round) {
    const Model model = random_tree(random, 10);
    const State s = random_state(random, model);
    Data data(model);
    ASSERT_TRUE(factor_mass<double>(model, data, s.q));
    InverseInertias inertias(model);
    inertias.update(model, data);
    const Eigen::LLT<Matrix> M(dense_mass(model, s.q));
    std::vector<Matrix> J;
    J.reserve(static_cast<std::size_t>(model.links()));
    for (int link = 0; link < model.links(); ++link) J.push_back(link_jacobian(model, s.q, link));
    for (std::size_t a = 0; a < J.size(); ++a) {
      for (std::size_t b = 0; b < J.size(); ++b) {
        const Matrix expected = J[a] * M.solve(Matrix(J[b].transpose()));
        const Matrix L = dense(inverse_inertia<double>(model, data, inertias, static_cast<int>(a),
                                                       static_cast<int>(b)));
        const double scale = 1 + expected.cwiseAbs().maxCoeff();
        worst = std::max(worst, (L - expected).cwiseAbs().maxCoeff() / scale);
      }
    }
  }
  std::printf("worst: %.1e\n", worst);
  EXPECT_LT(worst, 1e-11);
}

TEST(ImpulseResponse, IsThatOfTheDenseMatrices) {
  Random random(72);
  for (int round = 0; round < 50; ++round) {
    const Model model = random_tree(random, 12);
    const State s = random_state(random, model);
    Data data(model);
    ASSERT_TRUE(factor_mass<double>(model, data, s.q));
    const int link = static_cast<int>(random.word() % 12);
    const dse3 F{random.in_cube(1), random.in_cube(1)};
    Numbers dv(s.v.size());
    impulse_response<double>(model, data, link, F, dv);
    Eigen::VectorXd f(6);
    f << F.m.x, F.m.y, F.m.z, F.f.x, F.f.y, F.f.z;
    const Eigen::VectorXd expected =
        dense_mass(model, s.q).llt().solve(link_jacobian(model, s.q, link).transpose() * f);
    for (std::size_t i = 0; i < dv.size(); ++i) {
      ASSERT_NEAR(dv[i], expected(static_cast<long>(i)), 1e-11 * (1 + expected.norm()));
    }
  }
}

// The factors of forward dynamics serve as well. A body fixed to the world has zero inverse
// inertia.
TEST(InverseInertia, OfABodyAloneIsItsInverse) {
  ModelBuilder builder;
  must_build(builder.add({"ground"}));
  const Inertia J = Inertia(2.0, Vec3{0.1, 0.2, 0.25}).Xform(SE3(Vec3{0.1, 0.2, 0.3}));
  must_build(builder.add({"body", kWorld, FreeJoint{}, SE3(Vec3{1e9, 0, 0}), J}));
  const Model model = must_build(builder.build());
  Random random(73);
  State s = random_state(random, model);
  Data data(model);
  Numbers a(6);
  ASSERT_TRUE(forward_dynamics<double>(model, data, s.q, s.v, s.tau, {}, a));
  InverseInertias inertias(model);
  inertias.update(model, data);
  const se3 V{{1, 2, 3}, {-4, 5, 6}};
  const se3 back = inverse_inertia<double>(model, data, inertias, 1, 1) * (J * V);
  EXPECT_LT(norm(back.w - V.w) + norm(back.v - V.v), 1e-12);
  EXPECT_EQ(dense(inverse_inertia<double>(model, data, inertias, 0, 1)).norm(), 0.0);
  EXPECT_EQ(dense(inverse_inertia<double>(model, data, inertias, 0, 0)).norm(), 0.0);
}

// In the scalar T. `number` gives the value of one lane.
template <class T, class Number>
void holds_in(double bound, const Number& number) {
  Random random(74);
  const Model model = random_tree(random, 8, 8);
  const State s = random_state(random, model);
  Data data(model);
  ASSERT_TRUE(factor_mass<double>(model, data, s.q));
  InverseInertias inertias(model);
  inertias.update(model, data);
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): of double alone it is a copy
  const ModelT<base_t<T>> same(model);
  DataT<T> other(same);
  std::vector<T> q;
  for (const double x : s.q) q.emplace_back(static_cast<base_t<T>>(x));
  ASSERT_TRUE(factor_mass<T>(same, other, q));
  InverseInertiasT<T> others(same);
  others.update(same, other);
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b < 8; ++b) {
      const Response L = inverse_inertia<double>(model, data, inertias, a, b);
      const auto K = inverse_inertia<T>(same, other, others, a, b);
      const double scale = 1 + dense(L).cwiseAbs().maxCoeff();
      for (std::size_t k = 0; k < 6; ++k) {
        for (int i = 0; i < 3; ++i) {
          ASSERT_NEAR(number(K.columns[k].w[i]), L.columns[k].w[i], bound * scale);
          ASSERT_NEAR(number(K.columns[k].v[i]), L.columns[k].v[i], bound * scale);
        }
      }
    }
  }
}

TEST(InverseInertia, HoldsInFloatAndInLanes) {
  holds_in<float>(1e-3, [](float x) { return static_cast<double>(x); });
  holds_in<PackT<double, 4>>(1e-12, [](const PackT<double, 4>& x) { return x[3]; });
}

}  // namespace
}  // namespace vp::test
