// A user-defined joint: a bead that slides along a curve, here a cycloid. Public headers only.
//
// Huygens found in 1659 that a bead on a cycloid reaches the bottom after pi sqrt(r / g),
// independent of its starting point.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "vphysics/multibody/dynamics.h"

namespace {

// The curve of a point on a wheel of radius r that rolls along a ceiling; q is the wheel's angle s,
// 0 at the bottom:
//   p(s) = r (s + sin s, 0, 1 - cos s),  |dp/ds| = 2 r cos(s/2),  slope angle s/2
// The link's x axis is tangent to the curve, so it is rotated about -y by s/2.
class OnACycloid final : public vp::UserJoint {
 public:
  explicit OnACycloid(double radius) : r_(radius) {}

  int degrees_of_freedom() const override { return 1; }

  void evaluate(std::span<const double> q, std::span<const double> v, vp::SE3& T_joint_link,
                std::span<vp::se3> S, vp::se3& rate) const override {
    const double s = q[0];
    const auto [sine, cosine] = vp::sin_cos(s);
    const auto [sine_half, cosine_half] = vp::sin_cos(0.5 * s);
    T_joint_link =
        vp::SE3(vp::Exp(vp::Vec3{0, -0.5 * s, 0}), {r_ * (s + sine), 0, r_ * (1.0 - cosine)});
    // For ds/dt = 1, in the link's frame: angular velocity -1/2 about y, linear velocity along x.
    S[0] = {{0, -0.5, 0}, {2.0 * r_ * cosine_half, 0, 0}};
    // (dS/dt) v: only the speed along the curve depends on s.
    rate = {{0, 0, 0}, {-r_ * sine_half * v[0] * v[0], 0, 0}};
  }

 private:
  double r_;
};

}  // namespace

int main() {
  constexpr double kRadius = 0.5, kGravity = 9.81;
  vp::LinkSpec bead;
  bead.joint = std::make_shared<OnACycloid>(kRadius);
  bead.inertia = vp::Inertia(0.1, vp::Vec3{});  // a point mass of 0.1 kg
  vp::ModelBuilder builder;
  if (!builder.add(bead)) return 1;
  const auto model = builder.build();
  if (!model) return 1;
  vp::Data data(*model);

  const double law = vp::kPi * std::sqrt(kRadius / kGravity);
  std::printf("to the bottom in %.4f s, says Huygens\n", law);
  double worst = 0.0;
  for (const double start : {0.1, 1.0, 2.0}) {
    const double dt = 1e-5;
    std::vector<double> q{start}, v{0.0}, a{0.0};
    const std::vector<double> tau{0.0};
    double time = 0.0;
    for (; q[0] > 0.0; time += dt) {
      if (!vp::forward_dynamics<double>(*model, data, q, v, tau, {}, a)) return 1;
      v[0] += dt * a[0];
      q[0] += dt * v[0];
    }
    std::printf("from %.3f m up: %.4f s\n", kRadius * (1.0 - std::cos(start)), time);
    worst = std::fmax(worst, std::fabs(time - law));
  }
  return worst < 5e-5 ? 0 : 1;
}
