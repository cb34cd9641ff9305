// Simulates eight states of one model at once, one in each SIMD lane: the periods of pendulums
// released from eight angles. Public headers only.
//
// The calls are the same as for one state; the scalar is a pack of eight numbers.
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "vphysics/multibody/dynamics.h"

namespace {

constexpr int kLanes = 8;
using Pack = vp::PackT<double, kLanes>;
constexpr double kLength = 1.0, kGravity = 9.81;

// Period of a pendulum released at rest, by the arithmetic-geometric mean (Gauss).
double period(double angle) {
  double a = 1.0, b = std::cos(0.5 * angle);
  while (a - b > 1e-15) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return 2.0 * vp::kPi * std::sqrt(kLength / kGravity) / a;
}

}  // namespace

int main() {
  vp::LinkSpec bob;  // a point mass of 1 kg, below the hinge
  bob.joint = vp::RevoluteJoint{{0, 1, 0}};
  bob.inertia =
      vp::Inertia(1.0, {0, 0, -kLength}, {kLength * kLength, kLength * kLength, 0, 0, 0, 0});
  vp::ModelBuilder builder;
  if (!builder.add(bob)) return 1;
  const auto model = builder.build();
  if (!model) return 1;

  vp::DataT<Pack> data(*model);  // the model serves all scalars of its precision
  std::vector<Pack> q(1), v(1), a(1);
  const std::vector<Pack> tau(1);
  std::array<double, kLanes> let_go{}, quarter{};  // [rad], [s]
  for (int lane = 0; lane < kLanes; ++lane) {
    let_go[static_cast<std::size_t>(lane)] = 0.3 * (lane + 1);
    q[0].set(lane, 0.3 * (lane + 1));
  }

  const double dt = 1e-4;
  for (int step = 0; step < 20000; ++step) {
    if (!vp::forward_dynamics<Pack>(*model, data, q, v, tau, {}, a)) return 1;
    v[0] += Pack(dt) * a[0];
    q[0] += Pack(dt) * v[0];
    for (int lane = 0; lane < kLanes; ++lane) {
      double& at_bottom = quarter[static_cast<std::size_t>(lane)];
      // Interpolates the time within the step at which the angle was 0.
      if (at_bottom == 0.0 && q[0][lane] <= 0.0)
        at_bottom = dt * (step + 1) - q[0][lane] / v[0][lane];
    }
  }

  double worst = 0.0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const double law = period(let_go[lane]);
    std::printf("from %.1f rad: %.3f s, and %.3f s by Gauss\n", let_go[lane], 4.0 * quarter[lane],
                law);
    worst = std::fmax(worst, std::fabs(4.0 * quarter[lane] - law));
  }
  return worst < 5e-4 ? 0 : 1;
}
