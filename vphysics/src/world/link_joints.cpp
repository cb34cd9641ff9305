// Joints in rows (row_joints.h) within a step: where each is solved, and with what.
#include <algorithm>

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

// As their contacts would (find_bodies_on_links).
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
  return in_sub_steps(a, b) && !a.continuous && !b.continuous;
}

// Of an instant: whom joints in rows keep from going its own way.
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

void World::Impl::add_row_joints(const RowJointStep& step) {
  const bool of_sub_step = step.of == RowsOf::sub_step;
  const auto place = [&](std::uint32_t i) {
    const Body& body = bodies[i];
    return of_sub_step && joins_sub_steps(body)
               ? place_within_step(body, body_rows[i + 1], sub_step.start_ways[i])
               : place_of(body);
  };
  for (const std::uint32_t i : impacts.row_joints) {
    BodyJoint& joint = joints[i];
    if (is_in_sub_steps(joint) != of_sub_step) continue;
    add_rows(joint, i, place(joint.a), place(joint.b), step, impacts.joint_rows,
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

// At the end of a step.
void World::Impl::note_open_row_joints() {
  for (const std::uint32_t i : impacts.row_joints) {
    const BodyJoint& joint = joints[i];
    double size = 0.0;
    for (const auto& [index, T] :
         {std::pair{joint.a, &joint.T_a_joint}, std::pair{joint.b, &joint.T_b_joint}}) {
      const Body& body = bodies[index];
      if (body.motion != Motion::dynamic) continue;
      const Vec3 centre = body.is_link ? Vec3{} : body.centre;
      const double own = std::max(body.reach, norm(T->position() - centre));
      if (own > 0.0) size = size > 0.0 ? std::min(size, own) : own;
    }
    if (size > 0.0 &&
        is_far_open(joint, place_of(bodies[joint.a]), place_of(bodies[joint.b]), size)) {
      position_error_now = true;
    }
  }
}

}  // namespace vp
