#include "models.h"

#include <Eigen/Eigenvalues>
#include <cstdlib>

namespace vp::bench {
namespace {

// A solid box of this mass and size, with its centre in the link's frame. It is slightly rotated,
// so that no product of inertia is zero.
Inertia box(double mass, const Vec3& size, const Vec3& centre) {
  const double xx = size.x * size.x, yy = size.y * size.y, zz = size.z * size.z;
  const Inertia J(mass, (mass / 12.0) * Vec3{yy + zz, zz + xx, xx + yy});
  return J.InvXform(SE3(Exp(Vec3{0.1, -0.2, 0.15}), centre));
}

class Builder {
 public:
  explicit Builder(std::string name) { model_.name = std::move(name); }

  int base(const Inertia& J) {
    model_.free_base = true;
    return add({.name = "base", .joint = FreeJoint{}, .inertia = J});
  }
  // The joint's frame in its parent's: position, and rotation as a rotation vector.
  int revolute(std::string name, int parent, const Vec3& axis, const Vec3& position,
               const Inertia& J, const Vec3& turn = {}) {
    return add({.name = std::move(name),
                .parent = parent,
                .joint = RevoluteJoint{axis},
                .T_parent_joint = SE3(Exp(turn), position),
                .inertia = J});
  }
  BenchModel take() { return std::move(model_); }

 private:
  int add(LinkSpec link) {
    model_.links.push_back(std::move(link));
    return static_cast<int>(model_.links.size()) - 1;
  }
  BenchModel model_;
};

constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

// Seven joints about z, each frame rotated by a right angle from the previous one: a table-top arm.
BenchModel arm7() {
  constexpr double kRight = 0.5 * kPi;
  Builder b("arm7");
  int last = b.revolute("shoulder pan", kWorld, kZ, {0, 0, 0.33},
                        box(3.1, {0.12, 0.12, 0.24}, {0, -0.03, -0.06}));
  last = b.revolute("shoulder lift", last, kZ, {0, 0, 0},
                    box(3.2, {0.12, 0.24, 0.12}, {0, -0.07, 0.03}), {-kRight, 0, 0});
  last = b.revolute("upper arm", last, kZ, {0, -0.32, 0},
                    box(2.7, {0.11, 0.11, 0.2}, {0.04, 0.02, -0.07}), {kRight, 0, 0});
  last = b.revolute("elbow", last, kZ, {0.08, 0, 0},
                    box(2.6, {0.11, 0.2, 0.11}, {-0.04, 0.05, 0.02}), {kRight, 0, 0});
  last = b.revolute("forearm", last, kZ, {-0.08, 0.38, 0},
                    box(3.0, {0.1, 0.1, 0.26}, {0, 0.04, -0.11}), {-kRight, 0, 0});
  last = b.revolute("wrist", last, kZ, {0, 0, 0}, box(1.5, {0.11, 0.09, 0.09}, {0.05, 0, 0.01}),
                    {kRight, 0, 0});
  b.revolute("hand", last, kZ, {0.09, 0, 0}, box(1.2, {0.08, 0.2, 0.12}, {0.01, 0.01, 0.11}),
             {kRight, 0, 0});
  return b.take();
}

// A trunk of 18 kg on four legs of three joints.
BenchModel quadruped() {
  Builder b("quadruped");
  const int trunk = b.base(box(18.0, {0.53, 0.27, 0.24}, {0.01, 0.002, 0.03}));
  for (const double front : {1.0, -1.0}) {
    for (const double left : {1.0, -1.0}) {
      const std::string leg =
          std::string(front > 0 ? "front " : "hind ") + (left > 0 ? "left " : "right ");
      const int hip = b.revolute(leg + "hip", trunk, kX, {0.28 * front, 0.12 * left, 0},
                                 box(1.4, {0.12, 0.1, 0.1}, {0.06 * front, 0, 0}));
      const int thigh = b.revolute(leg + "thigh", hip, kY, {0.06 * front, 0.04 * left, 0},
                                   box(1.9, {0.08, 0.1, 0.25}, {0, 0.04 * left, -0.12}));
      b.revolute(leg + "shank", thigh, kY, {0, 0.1 * left, -0.25},
                 box(0.6, {0.05, 0.05, 0.32}, {0.01 * front, 0, -0.15}));
    }
  }
  return b.take();
}

void add_leg(Builder& b, int pelvis, double left, const std::string& side) {
  int last = b.revolute(side + "hip yaw", pelvis, kZ, {0, 0.09 * left, -0.08},
                        box(1.2, {0.1, 0.1, 0.1}, {0.01, 0, -0.03}));
  last = b.revolute(side + "hip roll", last, kX, {0, 0, -0.04},
                    box(1.6, {0.11, 0.1, 0.11}, {0, 0.01 * left, -0.01}));
  last = b.revolute(side + "hip pitch", last, kY, {0, 0, 0},
                    box(5.8, {0.13, 0.13, 0.38}, {0.01, 0, -0.19}));
  last = b.revolute(side + "knee", last, kY, {0, 0, -0.4},
                    box(3.4, {0.1, 0.1, 0.36}, {-0.01, 0, -0.18}));
  last = b.revolute(side + "ankle pitch", last, kY, {0, 0, -0.38},
                    box(0.6, {0.06, 0.06, 0.06}, {0, 0, -0.02}));
  b.revolute(side + "ankle roll", last, kX, {0, 0, -0.03},
             box(1.3, {0.24, 0.1, 0.06}, {0.05, 0, -0.03}));
}

void add_arm(Builder& b, int chest, double left, const std::string& side) {
  int last = b.revolute(side + "shoulder pitch", chest, kY, {0, 0.2 * left, 0.28},
                        box(0.9, {0.09, 0.1, 0.09}, {0, 0.03 * left, 0}), {0.2 * left, 0, 0});
  last = b.revolute(side + "shoulder roll", last, kX, {0, 0.05 * left, 0},
                    box(0.8, {0.09, 0.09, 0.1}, {0, 0.01 * left, -0.03}));
  last = b.revolute(side + "shoulder yaw", last, kZ, {0, 0, -0.05},
                    box(1.7, {0.09, 0.09, 0.24}, {0.01, 0, -0.12}));
  last = b.revolute(side + "elbow", last, kY, {0.01, 0, -0.26},
                    box(0.7, {0.08, 0.08, 0.12}, {0, 0, -0.04}));
  last = b.revolute(side + "forearm yaw", last, kZ, {0, 0, -0.1},
                    box(0.9, {0.07, 0.07, 0.18}, {0, 0, -0.08}));
  last = b.revolute(side + "wrist pitch", last, kY, {0, 0, -0.15},
                    box(0.2, {0.05, 0.05, 0.05}, {0, 0, -0.01}));
  b.revolute(side + "wrist roll", last, kX, {0, 0, -0.02},
             box(0.5, {0.09, 0.04, 0.18}, {0.01, 0, -0.08}));
}

// Two joints in the waist, two in the neck, arms of seven, legs of six: 36 velocities.
BenchModel humanoid() {
  Builder b("humanoid");
  const int pelvis = b.base(box(9.5, {0.2, 0.28, 0.18}, {-0.01, 0, 0.02}));
  const int waist =
      b.revolute("waist yaw", pelvis, kZ, {0, 0, 0.12}, box(2.0, {0.15, 0.2, 0.08}, {0, 0, 0.03}));
  const int chest = b.revolute("waist pitch", waist, kY, {0, 0, 0.07},
                               box(15.0, {0.2, 0.32, 0.38}, {0.01, 0, 0.18}));
  const int neck =
      b.revolute("neck yaw", chest, kZ, {0, 0, 0.4}, box(0.5, {0.07, 0.07, 0.09}, {0, 0, 0.03}));
  b.revolute("neck pitch", neck, kY, {0.01, 0, 0.07}, box(3.5, {0.19, 0.16, 0.22}, {0.02, 0, 0.1}));
  for (const double left : {1.0, -1.0}) add_arm(b, chest, left, left > 0 ? "left " : "right ");
  for (const double left : {1.0, -1.0}) add_leg(b, pelvis, left, left > 0 ? "left " : "right ");
  return b.take();
}

// Links of 10 cm with axes alternating between x and y.
BenchModel chain(std::string name, int joints) {
  Builder b(std::move(name));
  for (int i = 0; i < joints; ++i) {
    b.revolute("link " + std::to_string(i), i - 1, i % 2 == 0 ? kX : kY, {0, 0, i == 0 ? 0 : 0.1},
               box(0.4, {0.04, 0.05, 0.1}, {0.002, -0.001, 0.05}));
  }
  return b.take();
}

}  // namespace

const std::vector<std::string>& model_names() {
  static const std::vector<std::string> kNames = {"arm7",    "quadruped", "humanoid",
                                                  "chain10", "chain100",  "chain1000"};
  return kNames;
}

BenchModel make_model(std::string_view name) {
  if (name == "arm7") return arm7();
  if (name == "quadruped") return quadruped();
  if (name == "humanoid") return humanoid();
  return chain(std::string(name), std::atoi(std::string(name).c_str() + 5));
}

PrincipalInertia principal_inertia(const Inertia& J) {
  const Sym3 I = J.central();
  Eigen::Matrix3d full;
  full << I.xx, I.xy, I.zx, I.xy, I.yy, I.yz, I.zx, I.yz, I.zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(full);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  const auto column = [&](int i) { return Vec3{axes(0, i), axes(1, i), axes(2, i)}; };
  const Eigen::Vector3d moments = solver.eigenvalues();
  return {J.mass(),
          J.centre_of_mass(),
          {column(0), column(1), column(2)},
          {moments[0], moments[1], moments[2]}};
}

}  // namespace vp::bench
