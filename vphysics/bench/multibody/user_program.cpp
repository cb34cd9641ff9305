// A minimal user program; the benchmark measures the cost of compiling it. Exits with 0 if the
// acceleration of a horizontal pendulum is correct.
#include <cmath>
#include <cstdio>

#include "vphysics/multibody/dynamics.h"

int main() {
  vp::ModelBuilder builder;
  vp::LinkSpec link;
  link.joint = vp::RevoluteJoint{{0, 1, 0}};
  // 1 kg at 0.5 m along x, with negligible extent.
  link.inertia =
      vp::Inertia(1.0, vp::Vec3{1e-6, 1e-6, 1e-6}).InvXform(vp::SE3(vp::Vec3{0.5, 0, 0}));
  if (!builder.add(link)) return 1;
  const auto model = builder.build();
  if (!model) return 1;
  vp::Data data(*model);
  const double q[] = {0.0}, v[] = {0.0}, tau[] = {0.0};
  double a[1];
  if (!vp::forward_dynamics<double>(*model, data, q, v, tau, {}, a)) return 1;
  std::printf("%.6f rad/s^2\n", a[0]);
  return std::fabs(a[0] - 9.81 / 0.5) < 1e-3 ? 0 : 1;
}
