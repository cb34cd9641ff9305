// Impact stage: the contacts of an instant.
#include <algorithm>
#include <cmath>
#include <span>

#include "world/impact_stage.h"
#include "world/validate.h"

namespace vp {
namespace {

// Removes from the forces' velocity change the part that contacts and joints have cancelled: it
// does not count as approach speed in later impacts.
void remove_cancelled(Vec3& forced, const Vec3& change) {
  const double against = -dot(forced, change), size = dot(change, change);
  if (against > 0.0) forced += std::min(1.0, against / size) * change;
}

}  // namespace

void ImpactStage::find_discrete_contacts(double h) {
  discrete_contacts_.clear();
  for (const ColliderPair& pair : discrete_pairs_) {
    if (s_.colliders[pair.a].sensor || s_.colliders[pair.b].sensor) {
      pair_contacts_.test_sensor(pair);
    } else {
      pair_contacts_.add(pair, discrete_margin(pair, h), false, true, discrete_contacts_);
    }
  }
}

void ImpactStage::find_swept_contacts(bool warm) {
  for (const SweptPair& swept : swept_pairs_) {
    if (swept.sensor || swept.separation > s_.desc.contact_slop) continue;
    pair_contacts_.add(swept.pair, s_.desc.contact_slop, true, warm, contacts_);
  }
}

// Removes the part that the solve has cancelled from the forces' velocity changes of a body.
void ImpactStage::remove_cancelled_forces(std::uint32_t body, const Vec3& change_w,
                                          const Vec3& change_v) {
  remove_cancelled(forced_[body].w, change_w);
  remove_cancelled(forced_[body].v, change_v);
}

// Marks articulations in contact, and what joints in rows keep from rotating freely.
void ImpactStage::note_touched_articulations() {
  const auto touch = [this](const Body& body) {
    if (body.is_link) s_.articulations[body.articulation].touched = true;
  };
  for (Articulation& art : s_.articulations) art.touched = false;
  for (const solve::ContactConstraint& c : contacts_) {
    for (const std::uint32_t i : {c.a, c.b}) touch(s_.bodies[i]);
  }
  for (const std::uint32_t i : rows_.joints()) {
    const BodyJoint& joint = s_.joints[i];
    if (rows_.is_in_sub_steps(joint)) continue;
    for (const std::uint32_t b : {joint.a, joint.b}) {
      if (s_.bodies[b].rotation_locks > 0) in_contact_[b] = 1;
      touch(s_.bodies[b]);
    }
  }
}

RowJointStep ImpactStage::row_joint_step(double h, double dt, bool first) const {
  return {first ? RowsOf::first_instant : RowsOf::impact, dt, h, 1.0, s_.speed_unit};
}

// Solves contacts_ and the rows of joints. False: there are none.
bool ImpactStage::solve_instant(std::span<const std::uint32_t> solved, double h, double dt,
                                bool first) {
  rows_.add_rows(row_joint_step(h, dt, first));
  if (contacts_.empty() && rows_.empty()) return false;
  load_bodies(solved);
  begin_solve_articulations(first);
  solve::solve(rows_.context(contacts_, h, dt));
  return true;
}

// Solves all contacts at the start of a step (first), then those of the bodies that an impact
// affects.
void ImpactStage::solve_contacts(double h, double dt, bool first) {
  if (!first) {
    // An impact: contacts from the start of the step take part, with zero impulses.
    for (solve::ContactConstraint& c : discrete_contacts_) {
      c.rolling_impulse = {};
      for (int i = 0; i < c.count; ++i) {
        c.points[i].normal_impulse = c.points[i].tangent_impulse[0] =
            c.points[i].tangent_impulse[1] = 0.0;
      }
    }
  }
  if (first && swept_body_pairs_.empty()) {  // no impact can follow that would need them
    contacts_.swap(discrete_contacts_);
    discrete_contacts_.clear();
  } else {
    contacts_.assign(discrete_contacts_.begin(), discrete_contacts_.end());
  }
  find_swept_contacts(first);
  const std::span<const std::uint32_t> solved = first ? moving_bodies() : affected_;
  for (const std::uint32_t i : solved) in_contact_[i] = 0;
  for (const solve::ContactConstraint& c : contacts_) {
    if (c.swept) in_contact_[c.a] = in_contact_[c.b] = 1;
  }
  note_touched_articulations();
  bool has_rows = solve_instant(solved, h, dt, first);
  for (int again = 0; first && integrate_saturated_again(dt, has_rows, again > 0); ++again)
    has_rows = solve_instant(solved, h, dt, first);
  if (!has_rows) {
    if (first) store_implicit_impulses();
    return;
  }
  for (const std::uint32_t i : solved) {
    Body& body = s_.bodies[i];
    if (body.is_link || body.motion != Motion::dynamic) continue;
    if (first) remove_cancelled_forces(i, rows_.body(i).w - body.w, rows_.body(i).v - body.v);
    body.w = rows_.body(i).w;
    body.v = rows_.body(i).v;
    (void)stop_if_out_of_range(s_, i, start_poses_[i]);
  }
  rows_.note_link_impulses(contacts_);
  end_solve_articulations(first);
  if (first) store_implicit_impulses();
  rows_.take_back_joints(row_joint_step(h, dt, first));
  apply_corrections(solved);
  for (const solve::ContactConstraint& c : contacts_) {
    s_.counters.contacts += static_cast<std::uint32_t>(c.count);
  }
}

}  // namespace vp
