// Joints in rows (row_joints.h) within a step: which solve each one belongs to.
#include <algorithm>
#include <utility>

#include "solve/row_vector.h"

#include "world/impl.h"

namespace vp {

void World::Impl::list_row_joints() {
  impacts.row_joints.clear();
  for (std::uint32_t i = 0; i < joints.size(); ++i) {
    BodyJoint& joint = joints[i];
    if (!joint.alive || !joint.in_rows) continue;
    joint.force = joint.torque = {};
    impacts.row_joints.push_back(i);
  }
}

// Marks the bodies that are joined to links as bodies on links. Contacts do the same
// (find_bodies_on_links).
void World::Impl::find_bodies_joined_to_links() {
  for (const std::uint32_t i : impacts.row_joints) {
    const BodyJoint& joint = joints[i];
    for (const auto& [link, other] : {std::pair{joint.a, joint.b}, std::pair{joint.b, joint.a}}) {
      const Body& body = bodies[other];
      if (!bodies[link].is_link || !joins_sub_steps(body) || body.motion != Motion::dynamic)
        continue;
      put_on_link(other, articulations[bodies[link].articulation]);
    }
  }
}

bool World::Impl::is_in_sub_steps(const BodyJoint& joint) const {
  const Body &a = bodies[joint.a], &b = bodies[joint.b];
  return in_sub_steps(articulations, a, b) && !a.continuous && !b.continuous;
}

// At an instant: marks the bodies of joints in rows, which do not move freely.
void World::Impl::note_joined_bodies() {
  for (const std::uint32_t i : impacts.row_joints) {
    const BodyJoint& joint = joints[i];
    if (is_in_sub_steps(joint)) continue;
    for (const std::uint32_t b : {joint.a, joint.b}) {
      impacts.in_contact[b] = 1;
      if (bodies[b].is_link) articulations[bodies[b].articulation].touched = true;
    }
  }
}

// The poses after h, at the current velocities, of links with joints in rows.
void World::Impl::find_next_poses(double h) {
  if (impacts.row_joints.empty()) return;
  impacts.next_poses.resize(bodies.size());
  for (const std::uint32_t i : impacts.row_joints) {
    for (const std::uint32_t b : {joints[i].a, joints[i].b}) {
      if (bodies[b].is_link) articulations[bodies[b].articulation].needs_next_pose = true;
    }
  }
  for (Articulation& art : articulations) {
    if (!std::exchange(art.needs_next_pose, false) || art.sub_stepped) continue;
    art.for_poses_after(h, [&](int link, const SE3& T) {
      impacts.next_poses[art.bodies[static_cast<std::size_t>(link)]] = T;
    });
  }
}

RowEnd World::Impl::row_end(std::uint32_t index, const RowJointStep& step) const {
  const Body& body = bodies[index];
  if (step.of == RowsOf::sub_step && joins_sub_steps(body)) {
    const solve::BodyRow& row = body_rows[index + 1];
    const BodyPose now = pose_within_step(body, row, sub_step.start_displacements[index]);
    return {now, {vector_of(row.velocity + 3), vector_of(row.velocity)}, now};
  }
  RowEnd end{pose_of(body), {body.w, body.v}, pose_of(body)};
  if (step.of != RowsOf::first_instant || body.motion == Motion::fixed) return end;
  if (body.is_link) {
    end.next.T = impacts.next_poses[index];
    end.next.centre = end.next.T.position();
  } else {
    const Mat3 R = rotated(body.T.rotation(), step.h * body.w);
    const Vec3 arm = transposed_times(body.T.rotation(), end.now.centre - body.T.position());
    end.next.centre += step.h * body.v;
    end.next.T = SE3(R, end.next.centre - R * arm);
  }
  return end;
}

void World::Impl::add_row_joints(const RowJointStep& step) {
  const bool of_sub_step = step.of == RowsOf::sub_step;
  if (step.of == RowsOf::first_instant) find_next_poses(step.h);
  for (const std::uint32_t i : impacts.row_joints) {
    BodyJoint& joint = joints[i];
    if (is_in_sub_steps(joint) != of_sub_step) continue;
    add_rows(joint, i, row_end(joint.a, step), row_end(joint.b, step), step, impacts.joint_rows,
             impacts.joint_pairs);
  }
}

void World::Impl::take_back_row_joints(const RowJointStep& step) {
  take_back(impacts.joint_rows, impacts.joint_pairs, step, dt_now, joints);
  for (const solve::JointRow& row : impacts.joint_rows) {
    if (row.pair == solve::kNoPair) continue;
    const solve::JointPair& pair = impacts.joint_pairs[row.pair];
    for (const solve::PairEnd* end : {&pair.a, &pair.b}) {
      const Body& body = bodies[end->body];
      if (!body.is_link) continue;
      const Vec3 impulse = row.impulse * end->linear;
      const Vec3 moment =
          row.impulse * end->angular + cross(impacts.solver_bodies[end->body].x, impulse);
      articulations[body.articulation].add_external_impulse(body.link, impulse, moment);
    }
  }
}

// Checks the joints in rows at the end of a step.
void World::Impl::note_open_row_joints() {
  for (const std::uint32_t i : impacts.row_joints) {
    const BodyJoint& joint = joints[i];
    double size = 0.0;
    for (const auto& [index, T] :
         {std::pair{joint.a, &joint.T_a_joint}, std::pair{joint.b, &joint.T_b_joint}}) {
      const Body& body = bodies[index];
      if (body.motion != Motion::dynamic) continue;
      const Vec3 centre =
          body.is_link ? articulations[body.articulation].centre_of(body.link) : body.centre;
      const double own = std::max(body.bounding_radius, norm(T->position() - centre));
      if (own > 0.0) size = size > 0.0 ? std::min(size, own) : own;
    }
    if (size > 0.0 &&
        is_far_open(joint, pose_of(bodies[joint.a]), pose_of(bodies[joint.b]), size)) {
      position_error_now = true;
    }
  }
}

}  // namespace vp
