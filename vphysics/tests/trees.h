// Random trees of links for the tests of articulated dynamics.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "random.h"
#include "vphysics/multibody/configuration.h"
#include "vphysics/multibody/dynamics.h"

namespace vp::test {

template <class T>
T must_build(Expected<T>&& made) {
  if (!made) ADD_FAILURE() << made.error().message;
  return std::move(made).value();
}

// A slider on the curve (cos s, sin s, s^2 / 2). The x axis of its frame follows the tangent of the
// curve's horizontal projection.
class SliderOnACurve final : public UserJoint {
 public:
  int degrees_of_freedom() const override { return 1; }
  void evaluate(std::span<const double> q, std::span<const double> v, SE3& T_joint_link,
                std::span<se3> S, se3& rate) const override {
    const auto [sine, cosine] = sin_cos(q[0]);
    const double s = q[0];
    // The frame rotates about z with the horizontal projection of the curve.
    const Mat3 R = {{-sine, cosine, 0}, {-cosine, -sine, 0}, {0, 0, 1}};
    T_joint_link = SE3(R, {cosine, sine, 0.5 * s * s});
    S[0] = {{0, 0, 1}, {1, 0, s}};  // in the link frame
    rate = {{0, 0, 0}, {0, 0, v[0] * v[0]}};
  }
  bool subspace_derivatives(std::span<const double> /*q*/, std::span<const double> /*v*/,
                            std::span<se3> dS_dq, std::span<se3> drate_dq) const override {
    dS_dq[0] = {{0, 0, 0}, {0, 0, 1}};
    drate_dq[0] = {};
    return true;
  }
};

inline Joint random_joint(Random& random, int kind) {
  switch (kind % 10) {
    case 0:
      return RevoluteJoint{random.direction()};
    case 1:
      return PrismaticJoint{random.direction()};
    case 2:
      return HelicalJoint{random.direction(), random.uniform(-0.3, 0.3)};
    case 3:
      return CylindricalJoint{random.direction()};
    case 4:
      return UniversalJoint{random.direction(), random.direction()};
    case 5:
      return PlanarJoint{};
    case 6:
      return BallJoint{};
    case 7:
      return FreeJoint{};
    case 8:
      return FixedJoint{};
    default:
      return std::make_shared<SliderOnACurve>();
  }
}

inline Inertia random_body(Random& random) {
  const Vec3 a = random.in_cube(0.3);
  const Vec3 extent = {0.1 + a.x * a.x, 0.1 + a.y * a.y, 0.1 + a.z * a.z};
  const Vec3 principal = {extent.y + extent.z, extent.z + extent.x, extent.x + extent.y};
  const double mass = random.uniform(0.5, 2.0);
  return Inertia(mass, mass * principal).Xform(random.pose(0.3));
}

// A tree with every kind of joint: random kinds, or the first `kinds` in turn. Each link gets a
// random parent among the links before it.
inline Model random_tree(Random& random, int links, int kinds = 10) {
  ModelBuilder builder;
  for (int i = 0; i < links; ++i) {
    LinkSpec link;
    link.name = "link " + std::to_string(i);
    link.parent = static_cast<int>(random.word() % static_cast<unsigned>(i + 1)) - 1;
    link.joint =
        random_joint(random, kinds == 10 ? static_cast<int>(random.word() % 10) : i % kinds);
    link.T_parent_joint = random.pose(0.5);
    link.inertia = random_body(random);
    link.armature = 0.05;
    link.damping = random.uniform(0.0, 0.2);
    must_build(builder.add(link));
  }
  return must_build(builder.build());
}

struct State {
  std::vector<double> q, v, tau, a;
};
// Quaternions have unit length.
inline State random_state(Random& random, const Model& model) {
  State s;
  s.q = model.zero_coordinates();
  for (int link = 0; link < model.links(); ++link) {
    const Joint& joint = model.link(link).joint;
    const auto first = static_cast<std::size_t>(model.first_coordinate(link));
    const int count = coordinates_of(joint);
    const int quaternion = std::holds_alternative<BallJoint>(joint)   ? 0
                           : std::holds_alternative<FreeJoint>(joint) ? 3
                                                                      : count;
    for (int k = 0; k < quaternion; ++k) {
      s.q[first + static_cast<std::size_t>(k)] = random.uniform(-1.5, 1.5);
    }
    if (quaternion == count) continue;
    const Quaternion turn = to_quaternion(random.rotation());
    const double parts[4] = {turn.x, turn.y, turn.z, turn.w};
    for (std::size_t k = 0; k < 4; ++k) {
      s.q[first + static_cast<std::size_t>(quaternion) + k] = parts[k];
    }
  }
  for (int i = 0; i < model.velocities(); ++i) {
    s.v.push_back(random.uniform(-1, 1));
    s.tau.push_back(random.uniform(-1, 1));
    s.a.push_back(random.uniform(-1, 1));
  }
  return s;
}

inline std::vector<double> stepped(const Model& model, const std::vector<double>& q,
                                   const std::vector<double>& delta, double h = 1.0) {
  std::vector<double> scaled = delta, out(q.size());
  for (double& x : scaled) x *= h;
  integrate<double>(model, q, scaled, out);
  return out;
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::fabs(a[i] - b[i]));
  return worst;
}
inline double largest_of(const std::vector<double>& a) {
  double worst = 0.0;
  for (const double x : a) worst = std::max(worst, std::fabs(x));
  return worst;
}

}  // namespace vp::test
