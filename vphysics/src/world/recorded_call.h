// The calls that change a world, as data: written by a recorder, repeated by a replay. The index in
// the variant is the code in a recording: append new calls at its end.
#pragma once

#include <variant>
#include <vector>

#include "vphysics/world.h"

namespace vp {
namespace calls {

struct CreateBody {
  BodyDesc desc;
};
struct DestroyBody {
  BodyId body;
};
struct AddCollider {
  BodyId body;
  ColliderDesc desc;
};
struct CreateArticulation {
  std::vector<LinkSpec> links;
};
struct CreateJoint {
  BodyId a, b;
  JointDesc desc;
};
struct DestroyJoint {
  JointId joint;
};
struct SetPose {
  BodyId body;
  SE3 T_world_body;
};
struct SetVelocity {
  BodyId body;
  se3 velocity;
};
struct ApplyImpulse {
  BodyId body;
  Vec3 impulse, point;
};
struct SetJointStates {
  ArticulationId articulation;
  std::vector<double> coordinates, velocities;
};
struct SetJointState {
  ArticulationId articulation;
  std::uint32_t link = 0, dof = 0;
  double position = 0.0, velocity = 0.0;
};
struct SetLinkDrive {
  ArticulationId articulation;
  std::uint32_t link = 0, dof = 0;
  JointDrive drive;
};
struct SetJointDrive {
  JointId joint;
  JointDrive drive;
};
struct SetAxisDrive {
  JointId joint;
  JointAxis axis = JointAxis::x;
  JointDrive drive;
};
struct Restore {
  std::vector<std::byte> snapshot;
};
struct Wake {
  BodyId body;
};
struct SetMassFromColliders {
  BodyId body;
};

struct ApplyForce {
  BodyId body;
  Vec3 force, point;
};
struct ApplyTorque {
  BodyId body;
  Vec3 torque;
};
struct ApplyJointForce {
  ArticulationId articulation;
  std::uint32_t link = 0, dof = 0;
  double force = 0.0;
};

struct SetMotion {
  BodyId body;
  Motion motion = Motion::dynamic;
};
struct SetInertia {
  BodyId body;
  Inertia inertia;
};
struct SetDamping {
  BodyId body;
  double linear = 0.0, angular = 0.0;
};
struct SetGravityScale {
  BodyId body;
  double scale = 1.0;
};
struct SetAllowSleep {
  BodyId body;
  bool allow = true;
};
struct SetMaterial {
  ColliderId collider;
  Material material;
};
struct SetFilter {
  ColliderId collider;
  CollisionFilter filter;
};
struct SetSurfaceVelocity {
  ColliderId collider;
  Vec3 velocity;
};
struct RemoveCollider {
  ColliderId collider;
};
struct DestroyArticulation {
  ArticulationId articulation;
};
// With options that differ from the defaults.
struct CreateArticulationWithOptions {
  std::vector<LinkSpec> links;
  bool links_collide = false;
};

}  // namespace calls

struct RecordedCall {
  using What = std::variant<
      calls::CreateBody, calls::DestroyBody, calls::AddCollider, calls::CreateArticulation,
      calls::CreateJoint, calls::DestroyJoint, calls::SetPose, calls::SetVelocity,
      calls::ApplyImpulse, calls::SetJointStates, calls::SetJointState, calls::SetLinkDrive,
      calls::SetJointDrive, calls::SetAxisDrive, calls::Restore, calls::Wake,
      calls::SetMassFromColliders, calls::ApplyForce, calls::ApplyTorque, calls::ApplyJointForce,
      calls::SetMotion, calls::SetInertia, calls::SetDamping, calls::SetGravityScale,
      calls::SetAllowSleep, calls::SetMaterial, calls::SetFilter, calls::SetSurfaceVelocity,
      calls::RemoveCollider, calls::DestroyArticulation, calls::CreateArticulationWithOptions>;
  What what;
};

}  // namespace vp
