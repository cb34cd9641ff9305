// A four-bar linkage: a closed loop, as a tree with a constraint. Public headers only.
//
// Crank and coupler form one branch, the rocker the other; a hinge connects their ends. The sample
// rotates the crank once and compares the rocker's angle with the geometric solution. Then it
// releases the linkage.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "vphysics/multibody/constrained_dynamics.h"
#include "vphysics/multibody/quantities.h"

namespace {

constexpr double kCrank = 1.0, kCoupler = 3.0, kRocker = 2.5, kGround = 3.0;  // [m]

// A uniform bar of 1 kg/m along x, with a hinge about z at its start.
vp::LinkSpec bar(int parent, const vp::Vec3& hinge, double length) {
  vp::LinkSpec link;
  link.parent = parent;
  link.joint = vp::RevoluteJoint{{0, 0, 1}};
  link.T_parent_joint = vp::SE3(hinge);
  const double about_end = length * length * length / 3;
  link.inertia =
      vp::Inertia(length, {length * length / 2, 0, 0}, {0, about_end, about_end, 0, 0, 0});
  return link;
}

// The rocker's angle, from the two triangles on both sides of the diagonal.
double rocker_angle(double crank) {
  const double x = kCrank * std::cos(crank) - kGround, y = kCrank * std::sin(crank);
  const double diagonal = std::hypot(x, y);
  return std::atan2(y, x) -
         std::acos((kRocker * kRocker + diagonal * diagonal - kCoupler * kCoupler) /
                   (2 * kRocker * diagonal));
}

}  // namespace

int main() {
  vp::ModelBuilder builder;
  const auto crank = builder.add(bar(vp::kWorld, {0, 0, 0}, kCrank));
  const auto coupler = builder.add(bar(0, {kCrank, 0, 0}, kCoupler));
  const auto rocker = builder.add(bar(vp::kWorld, {kGround, 0, 0}, kRocker));
  if (!crank || !coupler || !rocker) return 1;
  const auto model = builder.build();
  if (!model) return 1;

  const auto loop = vp::ConstraintSet::make(
      *model, {vp::close_hinge({*coupler, vp::SE3(vp::Vec3{kCoupler, 0, 0})},
                               {*rocker, vp::SE3(vp::Vec3{kRocker, 0, 0})})});
  if (!loop) return 1;
  vp::ConstrainedData data(*model, *loop);

  // One revolution of the crank; each solution is the initial guess of the next.
  std::vector<double> q{0.0, 1.0, 2.0};  // crank, coupler (relative to the crank), rocker: a guess
  const std::array<int, 1> held{0};      // the crank's velocity
  double wrong = 0.0;
  for (int degrees = 0; degrees <= 360; degrees += 10) {
    q[0] = degrees * vp::kPi / 180;
    vp::ClosureOptions options;
    options.held = held;
    if (const auto closed = vp::close_loops(*model, data, q, options); !closed) {
      std::printf("%s\n", closed.error().message.c_str());
      return 1;
    }
    const double turns = std::remainder(q[2] - rocker_angle(q[0]), 2 * vp::kPi);
    wrong = std::max(wrong, std::fabs(turns));
    if (degrees % 60 == 0) std::printf("crank %3d: rocker %8.4f rad\n", degrees, q[2]);
  }
  std::printf("rocker within %.1g rad of geometry\n", wrong);

  // Two seconds of free motion, from rest; y is up.
  vp::Loads loads;
  loads.gravity = {0, -9.81, 0};
  std::vector<double> v(3), a(3), half_q(3), half_v(3);
  const std::vector<double> tau(3);
  const double dt = 1e-4, rate = 50.0;  // errors of the loop decay with a time constant of 1/50 s
  const auto accelerate = [&](const std::vector<double>& at_q, const std::vector<double>& at_v) {
    return vp::constrained_forward_dynamics(*model, data, at_q, at_v, tau, loads, rate, a)
        .has_value();
  };
  const auto energy = [&] {
    vp::forward_kinematics<double>(*model, data.links(), q, v);
    return vp::kinetic_energy<double>(*model, data.links()) +
           vp::potential_energy<double>(*model, data.links(), loads.gravity);
  };
  const double at_first = energy();
  double open = 0.0, drift = 0.0, fastest = 0.0;
  for (int step = 0; step < 20000; ++step) {
    if (!accelerate(q, v)) return 1;
    for (const double gap : data.residual()) open = std::max(open, std::fabs(gap));
    for (std::size_t i = 0; i < 3; ++i) {
      half_v[i] = v[i] + 0.5 * dt * a[i];
      half_q[i] = q[i] + 0.5 * dt * v[i];
    }
    if (!accelerate(half_q, half_v)) return 1;
    for (std::size_t i = 0; i < 3; ++i) {
      v[i] += dt * a[i];
      q[i] += dt * half_v[i];
      fastest = std::max(fastest, std::fabs(v[i]));
    }
    drift = std::max(drift, std::fabs(energy() - at_first));
  }
  std::printf("let go: up to %.1f rad/s, the loop within %.1g m, the energy within %.1g J\n",
              fastest, open, drift);
  return wrong < 1e-11 && fastest > 1.0 && open < 1e-6 && drift < 1e-3 ? 0 : 1;
}
