// Computed-torque control: an arm from a URDF file tracks a trajectory in a world. Inverse dynamics
// of its model gives the joint forces of the target motion; a PD term in the acceleration corrects
// the error. Public headers only.
//
//   vphysics_sample_control FILE
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "vphysics/multibody/dynamics.h"
#include "vphysics/urdf_world.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::printf("which file? samples/models/arm.urdf is one\n");
    return 2;
  }
  vp::World world;
  const auto arm = vp::add_urdf(world, argv[1]);
  if (!arm) {
    std::printf("%s\n", arm.error().message.c_str());
    return 1;
  }
  const vp::Model& model = arm->urdf.model;
  const auto n = static_cast<std::size_t>(model.velocities());
  vp::Data data(model);

  // begin: control
  constexpr double kStep = 0.001, kStiffness = 400.0, kDamping = 40.0;  // [1/s^2], [1/s]
  std::vector<double> wanted(n), a(n), tau(n);
  double worst = 0.0, largest = 0.0;
  for (int tick = 0; tick < 4000; ++tick) {
    const double t = kStep * tick;
    const auto q = world.coordinates(arm->articulation), v = world.velocities(arm->articulation);
    worst = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      // Each joint oscillates between zero and twice `swing`, starting at rest.
      const double swing = k + 1 < n ? 0.3 : 0.01, rate = 2.0 + 0.3 * static_cast<double>(k);
      const double target = swing * (1.0 - std::cos(rate * t));
      wanted[k] = swing * rate * std::sin(rate * t);
      const double target_a = swing * rate * rate * std::cos(rate * t);
      a[k] = target_a + kDamping * (wanted[k] - v[k]) + kStiffness * (target - q[k]);
      worst = std::max(worst, std::fabs(target - q[k]));
    }
    largest = std::max(largest, worst);
    vp::inverse_dynamics<double>(model, data, q, v, a, {}, tau);
    for (const vp::UrdfJoint& joint : arm->urdf.joints) {
      if (vp::velocities_of(model.link(joint.link).joint) == 0) continue;  // fixed joint
      const auto k = static_cast<std::size_t>(model.first_velocity(joint.link));
      // The dynamics do not include dry friction. Compensates it in the direction of the target
      // velocity, because a sticking joint has no velocity.
      const double force = tau[k] + std::copysign(joint.friction, wanted[k]);
      if (!world.apply_joint_force(arm->articulation, joint.link, 0, force)) return 1;
    }
    if (!world.step(kStep)) return 1;
  }
  // end: control
  std::printf("off by %.2g at the end, %.2g at most, radians or metres\n", worst, largest);
  return largest < 0.002 ? 0 : 1;
}
