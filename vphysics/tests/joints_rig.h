// Small worlds with joints.
#pragma once

#include "rig.h"

namespace vp::test {

inline BodyId add_anchor(World& world, const SE3& pose = {}) {
  BodyDesc desc;
  desc.motion = Motion::fixed;
  desc.T_world_body = pose;
  return must(world.create_body(desc));
}
// A body without a collider.
inline BodyId add_mass(World& world, const Inertia& inertia, const SE3& pose, const se3& V = {}) {
  BodyDesc desc;
  desc.T_world_body = pose;
  desc.velocity = V;
  desc.inertia = inertia;
  return must(world.create_body(desc));
}
// Describes a joint whose frames on both bodies coincide with T_world_joint at the current poses.
inline JointDesc joint_at(const World& world, BodyId a, BodyId b, const JointKind& kind,
                          const SE3& T_world_joint) {
  JointDesc desc;
  desc.kind = kind;
  desc.T_a_joint = Inv(world.pose(a)) * T_world_joint;
  desc.T_b_joint = Inv(world.pose(b)) * T_world_joint;
  return desc;
}
inline JointId join(World& world, BodyId a, BodyId b, const JointKind& kind,
                    const SE3& T_world_joint) {
  return must(world.create_joint(a, b, joint_at(world, a, b, kind, T_world_joint)));
}
// Rotation whose z axis is the world's y axis.
inline const Mat3 kAlongY{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};

inline WorldDesc weightless() {
  WorldDesc desc;
  desc.gravity = {};
  return desc;
}
inline void run(World& world, double seconds, double dt = 0.001) {
  const int steps = static_cast<int>(std::lround(seconds / dt));
  for (int i = 0; i < steps; ++i) must(world.step(dt));
}

}  // namespace vp::test
