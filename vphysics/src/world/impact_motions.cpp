// Impact stage: the motions of its bodies in a step, and their forces.
#include <algorithm>
#include <utility>

#include "world/free_rotation.h"
#include "world/impact_stage.h"
#include "world/validate.h"

namespace vp {
namespace {

// Removes a fraction of the velocity that forces have added, as far as it increased the speed.
void take_back(Vec3& velocity, const Vec3& added, double fraction) {
  const double with = dot(added, velocity);
  if (with > 0.0) velocity *= 1.0 - std::min(1.0, fraction * with / dot(velocity, velocity));
}

// The constant twist for h. For a tumbling body, the twist that leads to the same final rotation.
collide::Motion motion_of(const Body& body, const Velocity& more, double h) {
  collide::Motion motion{reference_point(body), body.v + more.v, body.w + more.w};
  const Vec3& mean = more.w == Vec3{} ? body.w : motion.w;
  if (h > 0.0 && body.tumbles() && body.rotates_freely() && !hardly_rotates(mean, h)) {
    const Mat3& R = body.T.rotation();
    const Vec3 w = transposed_times(R, mean);
    const FreeRotation rotation = free_rotation(body.central, body.inverse_central, w, h);
    motion.w = (1.0 / h) * (R * mean_rotation(rotation));
  }
  return motion;
}

}  // namespace

// Scales the warm-start impulses by the ratio of the step lengths.
void ImpactStage::rescale_impulses(double dt) {
  const double before = std::exchange(step_length_, dt);
  if (before == 0.0 || before == dt) return;
  const double scale = dt / before;
  const auto scaled = [scale](double x) { return in_range(scale * x) ? scale * x : 0.0; };
  pair_contacts_.scale(scale);
  for (BodyJoint& joint : s_.joints) {
    if (!joint.alive || !joint.in_rows) continue;
    for (double& impulse : joint.impulse) impulse = scaled(impulse);
    for (double& impulse : joint.stop) impulse = scaled(impulse);
  }
  for (Articulation& art : s_.articulations) {
    for (JointDof& dof : art.dofs) {
      for (double& impulse : dof.impulses) impulse = scaled(impulse);
    }
  }
}

void ImpactStage::reserve(std::size_t pairs) {
  const std::size_t n = s_.bodies.size();
  if (bounds_.size() == n && pairs <= reserved_) return;
  reserved_ = std::max(pairs, reserved_);
  // More manifolds than a pair has, unless many parts of a compound touch at once. So a world's
  // first contact allocates nothing.
  constexpr std::size_t kManifoldsOfPair = 64;
  swept_body_pairs_.reserve(n, reserved_);
  discrete_body_pairs_.reserve(n, reserved_);
  discrete_pairs_.reserve(reserved_);
  swept_pairs_.reserve(reserved_);
  discrete_contacts_.reserve(reserved_);
  contacts_.reserve(reserved_);
  s_.step_contacts.reserve(4 * reserved_);
  s_.shapes.manifolds.reserve(kManifoldsOfPair);
  queue_.reserve(reserved_);
  reached_sensors_.reserve(reserved_);
  bounds_.resize(n);
  motions_.resize(n);
  start_poses_.resize(n);
  first_impacts_.resize(n);
  affected_.reserve(n);
  moved_.reserve(n);
}

void ImpactStage::begin_step(double dt, std::size_t pairs) {
  rescale_impulses(dt);
  reserve(pairs);
  const std::size_t n = s_.bodies.size();
  stopped_.assign(n, 0);
  in_contact_.assign(n, 0);
  moves_rigidly_.assign(n, 0);
  advanced_.assign(n, 0);
  times_.assign(n, 0.0);
  affected_flags_.assign(n, Affected::none);
  if (scratch_is_dirty_) {
    scratch_is_dirty_ = false;
    drift_.assign(n, {});
    forced_.assign(n, {});
  }
}

void ImpactStage::note_start() {
  for (const std::uint32_t i : moving_bodies()) {
    drift_[i] = forced_[i] = {};
    if (!s_.bodies[i].is_link) start_poses_[i] = s_.bodies[i].T;
  }
}

// For the bodies that the impact stage moves.
void ImpactStage::integrate_forces(double dt) {
  for (const std::uint32_t i : moving_bodies()) {
    Body& body = s_.bodies[i];
    if (body.motion != Motion::dynamic || joins_sub_steps(body)) continue;
    forced_[i] = {body.w, body.v};
    if (body.is_link) continue;
    const Velocity a = s_.acceleration_of(body);
    body.v += dt * a.v;
    if (s_.loads.is_torqued(body)) body.w += dt * a.w;
    body.v *= 1.0 / (1.0 + dt * body.linear_damping);
    body.w *= 1.0 / (1.0 + dt * body.angular_damping);
  }
  integrate_articulations(dt);
  for (const std::uint32_t i : moving_bodies()) {
    const Body& body = s_.bodies[i];
    if (joins_sub_steps(body)) continue;
    const bool stopped = !body.is_link && stop_if_out_of_range(s_, i, start_poses_[i]);
    if (body.motion != Motion::dynamic) continue;
    forced_[i] = stopped ? Velocity{} : Velocity{body.w - forced_[i].w, body.v - forced_[i].v};
  }
}

void ImpactStage::note_sub_steps_of(std::uint32_t index, const Velocity& drift) {
  drift_[index] = drift;
  if (s_.bodies[index].is_solver_driven()) return;
  const Velocity a = s_.acceleration_of(s_.bodies[index]);
  forced_[index] = {s_.dt * a.w, s_.dt * a.v};
}

// Loads the bodies of `of` except links. Of links and other bodies, loads only those in contact or
// with row joints, which are few.
void ImpactStage::load_bodies(std::span<const std::uint32_t> of) {
  const auto load = [this](std::uint32_t i) {
    (void)rows_.load_body(i, reference_point(s_.bodies[i]), forced_[i]);
  };
  for (const std::uint32_t i : of) {
    if (!s_.bodies[i].is_link) load(i);
  }
  for (const solve::ContactConstraint& c : contacts_) {
    for (const std::uint32_t i : {c.a, c.b}) {
      const bool listed = !s_.bodies[i].is_link && s_.bodies[i].motion == Motion::dynamic;
      if (!listed) load(i);
    }
  }
  for (const solve::JointPair& pair : rows_.pairs()) {
    for (const std::uint32_t i : {pair.a.body, pair.b.body}) load(i);
  }
}

// Motions for the rest of the step. Bodies in contact move at the velocity that the solver has
// computed: at the mean velocity, their contacts would approach again at once.
void ImpactStage::refresh_motions(double h) {
  if (!swept_body_pairs_.dirty()) {
    for (const std::uint32_t i : moving_bodies()) refresh_motion_of(i, h);
    return;
  }
  for (std::uint32_t i = 0; i < s_.bodies.size(); ++i) {
    if (!s_.bodies[i].remote) refresh_motion_of(i, h);
  }
}
void ImpactStage::refresh_motion_of(std::uint32_t i, double h) {
  const Body& body = s_.bodies[i];
  if (body.is_link && body.first_collider == kNone) return;
  const bool stands = stopped_[i] || !body.alive || body.motion == Motion::fixed;
  motions_[i] = stands ? collide::Motion{reference_point(body), {}, {}}
                       : motion_of(body, drift_[i], in_contact_[i] ? 0.0 : h);
}

// Motions and AABBs for the rest of the step.
void ImpactStage::refresh_displacements(double h) {
  refresh_motions(h);
  refresh_bounds(h);
  collide_remote(h);
}

// Updates their separations after the bodies have advanced by h.
void ImpactStage::advance_discrete_contacts(double h) {
  for (solve::ContactConstraint& c : discrete_contacts_) {
    const collide::Motion &a = motions_[c.a], &b = motions_[c.b];
    for (int i = 0; i < c.count; ++i) {
      solve::ContactPoint& p = c.points[i];
      const Vec3 u = b.v + cross(b.w, p.position - b.x) - a.v - cross(a.w, p.position - a.x);
      p.separation += h * dot(c.normal, u);
    }
  }
}

void ImpactStage::apply_corrections(std::span<const std::uint32_t> of) {
  for (const std::uint32_t i : of) {
    Body& body = s_.bodies[i];
    if (body.is_link || body.motion != Motion::dynamic) continue;
    const solve::SolverBody& s = rows_.body(i);
    if (s.shift == Vec3{} && s.rotation == Vec3{}) continue;
    set_pose(body, s.x + s.shift, orthonormalized(Exp(s.rotation).matrix() * body.T.rotation()));
  }
}

// Time does not pass for stopped bodies, so forces must not accelerate them meanwhile. Otherwise
// such a body would gain speed in each step in which it is stopped, and fly off when released.
void ImpactStage::take_back_forces(double h) {
  const double fraction = h / s_.dt;
  for (const std::uint32_t i : moving_bodies()) {
    Body& body = s_.bodies[i];
    if (!stopped_[i] || body.is_link || body.motion != Motion::dynamic) continue;
    const Velocity a = s_.acceleration_of(body);
    take_back(body.v, s_.dt * a.v, fraction);
    take_back(body.w, s_.dt * a.w, fraction);
  }
  for (Articulation& art : s_.articulations) {
    if (!art.alive || !stopped_[art.bodies.front()]) continue;
    art.take_back_forces(fraction);
    follow(art, s_.bodies, s_.lists);
  }
}

}  // namespace vp
