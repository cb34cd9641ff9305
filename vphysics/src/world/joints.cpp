// Joints between bodies: creation, destruction, coordinates and drives.
#include "vphysics/assert.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/recorded_call.h"
#include "world/topology_hash.h"
#include "world/validate.h"

namespace vp {

bool disables_collision(const Bodies& bodies, const Joints& joints, std::uint32_t a,
                        std::uint32_t b) {
  if (bodies[b].first_joint == kNone) return false;
  for (std::uint32_t e = bodies[a].first_joint; e != kNone; e = joints[e / 2].next[e % 2]) {
    const BodyJoint& joint = joints[e / 2];
    if (!joint.collide && (joint.a == b || joint.b == b)) return true;
  }
  return false;
}

void link_joint(Bodies& bodies, Joints& joints, std::uint32_t index) {
  BodyJoint& joint = joints[index];
  for (const int side : {0, 1}) {
    Body& body = bodies[side == 0 ? joint.a : joint.b];
    const std::uint32_t edge = 2 * index + static_cast<std::uint32_t>(side);
    joint.next[side] = body.first_joint;
    joint.previous[side] = kNone;
    if (body.first_joint != kNone)
      joints[body.first_joint / 2].previous[body.first_joint % 2] = edge;
    body.first_joint = edge;
    if (locks_rotation(joint.spec)) ++body.rotation_locks;
    if (joint.in_rows) ++body.row_joints;
  }
}

void World::Impl::remove_joint(std::uint32_t index) {
  BodyJoint& joint = joints[index];
  for (const int side : {0, 1}) {
    Body& body = bodies[side == 0 ? joint.a : joint.b];
    const std::uint32_t next = joint.next[side], previous = joint.previous[side];
    if (next != kNone) joints[next / 2].previous[next % 2] = previous;
    (previous != kNone ? joints[previous / 2].next[previous % 2] : body.first_joint) = next;
    if (locks_rotation(joint.spec)) --body.rotation_locks;
    if (joint.in_rows) --body.row_joints;
  }
  contact_store.mark_contacts_dirty(bodies[joint.a]);
  if (joint.in_rows) lists.invalidate();
  joint.spec.user.reset();
  joints.release(index);
}

Expected<JointId> World::create_joint(BodyId a_id, BodyId b_id, const JointDesc& desc) {
  const Body *a = impl_->find(a_id), *b = impl_->find(b_id);
  if (!a) return unknown_id("create_joint", "body a");
  if (!b) return unknown_id("create_joint", "body b");
  if (a == b) return invalid("create_joint: a body cannot be joined to itself; name two bodies");
  if (a->motion != Motion::dynamic && b->motion != Motion::dynamic)
    return invalid("create_joint: one of the two bodies must be dynamic");
  if (a->motion == b->motion && !a->is_link && !can_be_joined(a->continuous, *b))
    return invalid(Errc::unsupported, std::string("create_joint: ") + kNotJoined);
  if (auto problem = problem_with(desc)) return invalid("create_joint: " + *problem);

  const std::uint32_t index = impl_->joints.take();
  BodyJoint& joint = impl_->joints[index];
  joint.a = a_id.index - 1;
  joint.b = b_id.index - 1;
  joint.collide = desc.collide;
  const auto straight = [](const SE3& T) {
    return SE3(orthonormalized(T.rotation()), T.position());
  };
  joint.T_a_joint = straight(desc.T_a_joint);
  joint.T_b_joint = straight(desc.T_b_joint);
  joint.frequency = desc.frequency;
  joint.damping_ratio = desc.damping_ratio;
  joint.spec = spec_of(desc.kind);
  joint.main = main_slot(desc.kind);
  joint.in_rows = is_in_rows(impl_->bodies, joint);
  link_joint(impl_->bodies, impl_->joints, index);
  for (const Body* body : {a, b}) {
    if (body->is_link) impl_->follow(impl_->articulations[body->articulation]);
  }
  if (joint.in_rows) impl_->lists.invalidate();
  joint.start[0] = impl_->bodies[joint.a].T;
  joint.start[1] = impl_->bodies[joint.b].T;
  joint.rotated[0] = first_rotation(joint.spec);
  impl_->wake(joint.a);
  impl_->wake(joint.b);
  impl_->contact_store.mark_contacts_dirty(impl_->bodies[joint.a]);
  TopologyHash(impl_->topology_hash).add(0x500u + index, a_id.index, b_id.index, desc);
  if (impl_->recorder) impl_->log({calls::CreateJoint{a_id, b_id, desc}});
  return JointId{index + 1, joint.generation};
}

Expected<void> World::destroy_joint(JointId id) {
  if (!impl_->find(id)) return unknown_id("destroy_joint", "the joint");
  const BodyJoint& joint = impl_->joints[id.index - 1];
  impl_->wake(joint.a);
  impl_->wake(joint.b);
  impl_->remove_joint(id.index - 1);
  TopologyHash(impl_->topology_hash).add(0x600u + id.index);
  if (impl_->recorder) impl_->log({calls::DestroyJoint{id}});
  return {};
}

bool World::contains(JointId id) const {
  return impl_->find(id) != nullptr;
}

namespace {

double number_or_zero(const std::optional<double>& x) {
  VP_ASSERT(x && "joint_coordinate: the joint has no such coordinate");
  return x.value_or(0.0);
}

}  // namespace

double World::joint_coordinate(JointId id) const {
  const BodyJoint* joint = impl_->find(id);
  VP_ASSERT(joint && joint->main >= 0 && "joint_coordinate: name an axis, or an id that exists");
  if (!joint || joint->main < 0) return 0.0;
  return number_or_zero(coordinate(*joint, pose_of(impl_->bodies[joint->a]),
                                   pose_of(impl_->bodies[joint->b]), joint->main));
}

double World::joint_coordinate(JointId id, JointAxis axis) const {
  const BodyJoint* joint = impl_->find(id);
  const bool has =
      joint && joint->spec.form == JointSpec::Form::axes && axis <= JointAxis::rotation_z;
  VP_ASSERT(has && "joint_coordinate: no such joint, or it has no axes");
  if (!has) return 0.0;
  return number_or_zero(coordinate(*joint, pose_of(impl_->bodies[joint->a]),
                                   pose_of(impl_->bodies[joint->b]), static_cast<int>(axis)));
}

double World::joint_residual(JointId id, int row) const {
  const BodyJoint* joint = impl_->find(id);
  const bool has = joint && joint->spec.form == JointSpec::Form::user && row >= 0;
  VP_ASSERT(has && "joint_residual: no such joint, or not a UserConstraint");
  if (!has) return 0.0;
  return number_or_zero(
      coordinate(*joint, pose_of(impl_->bodies[joint->a]), pose_of(impl_->bodies[joint->b]), row));
}

namespace {

Expected<void> drive_slot(BodyJoint& joint, int slot, const JointDrive& drive) {
  if (auto problem = problem_with(drive)) return invalid("set_drive: " + *problem);
  AxisDesc& desc = joint.spec.axes[slot];
  if (desc.motion == AxisMotion::locked)
    return invalid("set_drive: the joint holds this coordinate; drive one that it leaves free");
  desc.drive = drive;
  joint.rows_sub_step = 0.0;
  return {};
}

}  // namespace

Expected<void> World::set_drive(JointId id, const JointDrive& drive) {
  BodyJoint* joint = impl_->find(id);
  if (!joint) return unknown_id("set_drive", "the joint");
  if (joint->main < 0 || joint->spec.form != JointSpec::Form::axes)
    return invalid(
        "set_drive: the joint has no drive; hinges, sliders, cones and six degrees have");
  const auto driven = drive_slot(*joint, joint->main, drive);
  if (!driven) return driven;
  impl_->wake(joint->a);
  impl_->wake(joint->b);
  if (impl_->recorder) impl_->log({calls::SetJointDrive{id, drive}});
  return driven;
}

Expected<void> World::set_drive(JointId id, JointAxis axis, const JointDrive& drive) {
  BodyJoint* joint = impl_->find(id);
  if (!joint) return unknown_id("set_drive", "the joint");
  const bool swings = axis == JointAxis::rotation_x || axis == JointAxis::rotation_y;
  if (joint->spec.form != JointSpec::Form::axes || axis > JointAxis::rotation_z ||
      (joint->spec.cone && swings))
    return invalid("set_drive: the joint has no drive of this axis");
  const auto driven = drive_slot(*joint, static_cast<int>(axis), drive);
  if (!driven) return driven;
  impl_->wake(joint->a);
  impl_->wake(joint->b);
  if (impl_->recorder) impl_->log({calls::SetAxisDrive{id, axis, drive}});
  return driven;
}

JointForce World::joint_force(JointId id) const {
  const BodyJoint* joint = impl_->find(id);
  VP_ASSERT(joint && "joint_force: the joint does not exist (any more)");
  if (!joint) return {};
  return {joint->force, joint->torque};
}

void forget_joints(const Body& body, Joints& joints) {
  for (std::uint32_t e = body.first_joint; e != kNone; e = joints[e / 2].next[e % 2]) {
    joints[e / 2].forget_impulses();
  }
}

}  // namespace vp
