// Simulates two hinged rods, released from a horizontal position. Public headers only.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "vphysics/multibody/dynamics.h"
#include "vphysics/multibody/integrators.h"
#include "vphysics/multibody/quantities.h"

namespace {

// A uniform rod of 1 kg and 1 m, below its frame's origin: m l^2 / 3 about its end.
constexpr double kMass = 1.0, kLength = 1.0, kGravity = 9.81;
const vp::Inertia kRod(kMass, kMass* vp::Vec3{0, 0, -kLength / 2},
                       {kMass * kLength * kLength / 3, kMass* kLength* kLength / 3, 0, 0, 0, 0});

// begin: model
vp::Expected<vp::Model> make_pendulum() {
  vp::LinkSpec upper;
  upper.name = "upper";
  upper.joint = vp::RevoluteJoint{{0, 1, 0}};  // rotates about y
  upper.inertia = kRod;

  vp::LinkSpec lower = upper;
  lower.name = "lower";
  lower.parent = 0;  // the first link
  lower.T_parent_joint = vp::SE3(vp::Vec3{0, 0, -kLength});

  vp::ModelBuilder builder;
  for (const vp::LinkSpec& link : {upper, lower}) {
    if (const auto added = builder.add(link); !added) return tl::make_unexpected(added.error());
  }
  return builder.build();
}
// end: model

double energy(const vp::Model& model, vp::Data& data, const std::vector<double>& q,
              const std::vector<double>& v) {
  vp::forward_kinematics<double>(model, data, q, v);
  return vp::kinetic_energy<double>(model, data) +
         vp::potential_energy<double>(model, data, {0, 0, -kGravity});
}

}  // namespace

int main() {
  const auto model = make_pendulum();
  if (!model) {
    std::printf("%s\n", model.error().message.c_str());
    return 1;
  }
  vp::Data data(*model);  // working memory of the algorithms

  std::vector<double> q{vp::kPi / 2, 0.0}, v(2), a(2);  // the second angle is relative to the first
  const std::vector<double> tau(2);                     // no motors
  if (!vp::forward_dynamics<double>(*model, data, q, v, tau, {}, a)) return 1;
  std::printf("let go: %.4f and %.4f rad/s^2\n", a[0], a[1]);
  // By Lagrange's equations of two horizontal rods: -9/7 g/l and +12/7 g/l.
  const double wrong = std::max(std::fabs(a[0] + 9.0 / 7.0 * kGravity / kLength),
                                std::fabs(a[1] - 12.0 / 7.0 * kGravity / kLength));

  vp::IntegratorData stepper(*model);  // memory of an integrator, with its own data
  const double at_first = energy(*model, data, q, v);
  double drift = 0.0;
  for (int step = 1; step <= 5000; ++step) {
    if (!vp::step_rk4<double>(*model, stepper, q, v, {.h = 0.001})) return 1;
    drift = std::max(drift, std::fabs(energy(*model, data, q, v) - at_first));
    if (step % 1000 == 0) std::printf("%d s: %8.4f %8.4f rad\n", step / 1000, q[0], q[1]);
  }
  std::printf("energy within %.1g J\n", drift);
  return wrong < 1e-12 && drift < 1e-7 ? 0 : 1;
}
