// A quadruped from a URDF file, with its collision geometry: it stands with PD-controlled joints,
// receives a push, and recovers. Public headers only.
//
//   vphysics_sample_quadruped FILE
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "vphysics/urdf_world.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::printf("which file? samples/models/quadruped.urdf is one\n");
    return 2;
  }
  // begin: quadruped
  vp::World world;
  vp::BodyDesc ground_desc;
  ground_desc.motion = vp::Motion::fixed;
  const auto ground = world.create_body(ground_desc);
  vp::ColliderDesc floor;
  floor.shape = vp::HalfSpace{};
  if (!ground || !world.add_collider(*ground, floor)) return 1;

  vp::UrdfWorldOptions options;
  options.base = vp::UrdfBase::floating;
  options.T_world_root = vp::SE3(vp::Vec3{0.0, 0.0, 0.33});
  options.material.friction = 0.8;
  const auto robot = vp::add_urdf(world, argv[1], options);
  if (!robot) {
    std::printf("%s\n", robot.error().message.c_str());  // file, line and remedy
    return 1;
  }
  for (const std::string& note : robot->notes) std::printf("note: %s\n", note.c_str());

  // Knees bent: the initial configuration of the joints, and the target of their drives.
  const vp::Model& model = robot->urdf.model;
  std::vector<double> q = model.zero_coordinates();
  std::vector<vp::JointDrive> drives(static_cast<std::size_t>(model.velocities()));
  for (const vp::UrdfJoint& joint : robot->urdf.joints) {
    if (vp::velocities_of(model.link(joint.link).joint) != 1) continue;  // fixed joint
    const bool thigh = joint.name.find("thigh") != std::string::npos;
    const bool shank = joint.name.find("shank") != std::string::npos;
    vp::JointDrive& drive = drives[static_cast<std::size_t>(model.first_velocity(joint.link))];
    drive.position = thigh ? 0.8 : shank ? -1.6 : 0.0;
    drive.stiffness = 150.0;         // [N m/rad]
    drive.damping = 4.0;             // [N m s/rad]
    drive.max_force = joint.effort;  // [N m]
    q[static_cast<std::size_t>(model.first_coordinate(joint.link))] = drive.position;
  }
  const std::vector<double> at_rest(drives.size());
  if (!world.set_joint_states(robot->articulation, q, at_rest)) return 1;
  if (!world.set_drives(robot->articulation, drives)) return 1;

  const vp::BodyId trunk = robot->link_body(world, "trunk");
  double lowest = 1.0;
  for (int tick = 0; tick < 3000; ++tick) {
    if (tick >= 1000 && tick < 1200 && !world.apply_force(trunk, {0.0, 40.0, 0.0})) return 1;
    if (!world.step(0.001)) return 1;
    lowest = std::fmin(lowest, world.pose(trunk).position().z);
  }

  // The contact force on each foot.
  double carried = 0.0;
  for (const char* leg : {"front_left", "front_right", "rear_left", "rear_right"}) {
    std::vector<vp::ContactPoint> points;
    world.contacts_of(robot->link_body(world, std::string(leg) + "_foot"), points);
    double force = 0.0;
    for (const vp::ContactPoint& point : points) force += point.normal_impulse / 0.001;
    std::printf("%-12s carries %5.1f N\n", leg, force);
    carried += force;
  }
  // end: quadruped

  double mass = 0.0;
  for (int link = 0; link < model.links(); ++link) mass += model.link(link).inertia.mass();
  const vp::SE3 T = world.pose(trunk);
  std::printf("the trunk stands at %.3f m, never below %.3f m; the feet carry %.2f N of %.2f N\n",
              T.position().z, lowest, carried, 9.81 * mass);
  // The height of two equal links of 0.2 m at 0.8 rad to the vertical, on a foot of 0.02 m, minus
  // the deflection of the drives.
  const double straight = 2 * 0.2 * std::cos(0.8) + 0.02;
  const bool stands = T.rotation().cz.z > 0.999 && T.position().z < straight + 0.001 &&
                      T.position().z > straight - 0.03 && lowest > straight - 0.05;
  return stands && std::fabs(carried / (9.81 * mass) - 1.0) < 0.01 ? 0 : 1;
}
