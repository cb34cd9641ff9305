// A user-defined joint with several degrees of freedom: a chain of screws, as a product of
// exponentials. Public headers only.
//
//   T(q) = e^(S_1 q_1) e^(S_2 q_2) ... e^(S_n q_n)
//
// In the link's frame, column k is Ad(inverse of the product of the later exponentials) S_k. It
// rotates with the velocity of the later screws: its rate is ad(S_k, sum of S_j v_j, j > k).
// Source: Brockett, Robotic Manipulators and the Product of Exponentials Formula, 1984.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "vphysics/multibody/dynamics.h"

namespace {

class Exponentials final : public vp::UserJoint {
 public:
  // One to six screws, in the joint's frame at zero coordinates.
  explicit Exponentials(std::vector<vp::se3> screws) : screws_(std::move(screws)) {}

  int degrees_of_freedom() const override { return static_cast<int>(screws_.size()); }

  void evaluate(std::span<const double> q, std::span<const double> v, vp::SE3& T_joint_link,
                std::span<vp::se3> S, vp::se3& rate) const override {
    T_joint_link = vp::SE3();
    vp::se3 after{};  // velocity of the screws after screw k
    rate = {};
    for (std::size_t k = screws_.size(); k-- > 0;) {
      S[k] = vp::InvAd(T_joint_link, screws_[k]);
      rate = rate + v[k] * vp::ad(S[k], after);
      after = after + v[k] * S[k];
      T_joint_link = vp::Exp(q[k] * screws_[k]) * T_joint_link;
    }
  }

 private:
  std::vector<vp::se3> screws_;
};

const vp::Inertia kBody(2.0, vp::Vec3{0.3, 0.4, 0.5});

// The same motion with joints of the library and massless links between them.
vp::Expected<vp::Model> of_separate_joints() {
  vp::LinkSpec turn, screw, slide;
  turn.joint = vp::RevoluteJoint{{0, 0, 1}};
  screw.parent = 0;
  screw.joint = vp::HelicalJoint{{0, 1, 0}, 0.1};
  screw.T_parent_joint = vp::SE3(vp::Vec3{0.5, 0, 0});
  slide.parent = 1;
  slide.joint = vp::PrismaticJoint{{1, 0, 0}};
  slide.T_parent_joint = vp::SE3(vp::Vec3{-0.5, 0, 0});  // back to the start of the chain
  slide.inertia = kBody;
  vp::ModelBuilder builder;
  for (const vp::LinkSpec& link : {turn, screw, slide}) {
    if (const auto added = builder.add(link); !added) return tl::make_unexpected(added.error());
  }
  return builder.build();
}

vp::Expected<vp::Model> of_one_joint() {
  const vp::Vec3 axis{0, 1, 0}, through{0.5, 0, 0};
  vp::LinkSpec link;
  link.joint = std::make_shared<Exponentials>(std::vector<vp::se3>{
      {{0, 0, 1}, {0, 0, 0}},                         // rotates about z
      {axis, vp::cross(through, axis) + 0.1 * axis},  // a screw with an axis beside the origin
      {{0, 0, 0}, {1, 0, 0}},                         // translates along x
  });
  link.inertia = kBody;
  vp::ModelBuilder builder;
  if (const auto added = builder.add(link); !added) return tl::make_unexpected(added.error());
  return builder.build();
}

}  // namespace

int main() {
  const auto one = of_one_joint(), separate = of_separate_joints();
  if (!one || !separate) return 1;
  vp::Data data_one(*one), data_separate(*separate);

  const std::vector<double> q{0.4, -0.7, 0.2}, v{1.0, -2.0, 0.5}, tau{0.3, 0.2, -0.1};
  std::vector<double> a(3), b(3);
  if (!vp::forward_dynamics<double>(*one, data_one, q, v, tau, {}, a)) return 1;
  if (!vp::forward_dynamics<double>(*separate, data_separate, q, v, tau, {}, b)) return 1;

  double differ = 0.0;
  std::printf("%12s %14s\n", "one joint", "three joints");
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf("%12.6f %14.6f\n", a[i], b[i]);
    differ = std::max(differ, std::fabs(a[i] - b[i]));
  }
  return differ < 1e-12 ? 0 : 1;
}
