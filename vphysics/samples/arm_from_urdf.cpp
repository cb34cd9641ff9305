// Computes the joint forces that hold an arm from a URDF file level against gravity. Public headers
// only.
//
//   vphysics_sample_arm_from_urdf FILE
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "vphysics/multibody/dynamics.h"
#include "vphysics/multibody/urdf.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::printf("which file? samples/models has one\n");
    return 2;
  }
  const auto arm = vp::load_urdf(argv[1]);
  if (!arm) {
    std::printf("%s\n", arm.error().message.c_str());  // file, line and cause
    return 1;
  }
  const vp::Model& model = arm->model;
  std::printf("%s: %d links, %d joints that move\n", arm->name.c_str(), model.links(),
              model.velocities());
  for (const std::string& note : arm->notes) std::printf("note: %s\n", note.c_str());

  // The shoulder rotated by pi/2, all other joints at zero: the arm is level.
  const vp::UrdfJoint* shoulder = arm->find_joint("shoulder");
  const int finger = model.find_link("finger");
  if (!shoulder || finger < 0) return 1;
  std::vector<double> q = model.zero_coordinates();
  q[static_cast<std::size_t>(model.first_coordinate(shoulder->link))] = vp::kPi / 2;

  const auto n = static_cast<std::size_t>(model.velocities());
  const std::vector<double> rest(n);
  std::vector<double> hold(n), a(n);
  vp::Data data(model);
  vp::inverse_dynamics<double>(model, data, q, rest, rest, {}, hold);
  std::printf("\n%-10s %10s %10s\n", "joint", "holds", "can hold");
  for (const vp::UrdfJoint& joint : arm->joints) {
    if (vp::velocities_of(model.link(joint.link).joint) == 0) continue;  // fixed joint
    const auto i = static_cast<std::size_t>(model.first_velocity(joint.link));
    std::printf("%-10s %10.4f %10.4g\n", joint.name.c_str(), hold[i], joint.effort);
  }
  const vp::Vec3 tip = vp::T_world_link(model, data, finger).position();
  std::printf("the finger is at (%.3f, %.3f, %.3f) m\n", tip.x, tip.y, tip.z);

  // With these forces the arm does not accelerate.
  if (!vp::forward_dynamics<double>(model, data, q, rest, hold, {}, a)) return 1;
  double fastest = 0.0;
  for (const double each : a) fastest = std::max(fastest, std::fabs(each));

  // The moment at the shoulder: mass times lever of upper arm, forearm, wrist, hand and finger.
  const double moment =
      9.81 * (4.0 * 0.25 + 2.5 * (0.5 + 0.2) + 0.6 * 0.9 + 0.8 * (0.9 + 0.05) + 0.1 * (0.9 + 0.1));
  const double held = hold[static_cast<std::size_t>(model.first_velocity(shoulder->link))];
  return fastest < 1e-9 && std::fabs(held + moment) < 1e-9 && std::fabs(tip.x - 1.0) < 1e-12 ? 0
                                                                                             : 1;
}
