#include "core/pull.h"

#include <algorithm>

namespace sandbox {
namespace {

constexpr double kFrequency = 2.0 * vp::kPi * 4.0;  // [rad/s]: follows a hand smoothly
constexpr double kStrongest = 60.0 * 9.81;          // [m/s^2]: can lift a body under a tower

}  // namespace

vp::Vec3 pull_impulse(const vp::World& world, const Grip& grip, double dt) {
  const vp::SE3 T = world.pose(grip.body);
  const vp::se3 V = world.velocity(grip.body);
  const double m = grip.inertia.mass();
  const double k = m * kFrequency * kFrequency, c = 2.0 * m * kFrequency;
  const vp::Vec3 x = T * grip.point_body;
  const vp::Vec3 v = T.rotate(V.v + cross(V.w, grip.point_body));
  const vp::Vec3 r = T.rotate(grip.point_body - grip.inertia.centre_of_mass());
  const vp::Sym3 I_inv = vp::inverse(vp::rotated(T.rotation(), grip.inertia.central()));

  // (1 + s K) P = -dt (k (x - t) + (c + dt k) v)
  const double s = dt * (c + dt * k);
  const auto column = [&](const vp::Vec3& e) {
    return e + s * ((1.0 / m) * e + cross(I_inv * cross(r, e), r));
  };
  const vp::Vec3 cx = column({1, 0, 0}), cy = column({0, 1, 0}), cz = column({0, 0, 1});
  const vp::Sym3 A{cx.x, cy.y, cz.z, cx.y, cy.z, cz.x};
  const vp::Vec3 P = -dt * (vp::inverse(A) * (k * (x - grip.target) + (c + dt * k) * v));
  const double max = m * kStrongest * dt, size = norm(P);
  return size > max ? (max / size) * P : P;
}

}  // namespace sandbox
