// Impact stage: from pairs to constraints, and from solved constraints to events and warm starts.
#include <algorithm>
#include <cmath>
#include <span>

#include "world/impl.h"
#include "world/validate.h"

namespace vp {
namespace {

// The records of all manifolds of the pair.
std::span<const PairRecord> records_of(const std::vector<PairRecord>& sorted, std::uint64_t key) {
  const auto it = std::lower_bound(sorted.begin(), sorted.end(), key,
                                   [](const PairRecord& r, std::uint64_t k) { return r.key < k; });
  auto end = it;
  while (end != sorted.end() && end->key == key) ++end;
  return {it, end};
}
bool touches(std::span<const PairRecord> of_pair) {
  return !of_pair.empty() && of_pair[0].touching;
}

// The old point with the same feature id; otherwise, since feature ids change when edges pass over
// each other, the nearest old point within range.
const PairPoint* point_of(std::span<const PairRecord> of_pair, std::uint32_t feature,
                          const Vec3& position, double range) {
  const PairPoint* nearest = nullptr;
  double min_distance_squared = range * range;
  for (const PairRecord& record : of_pair) {
    for (std::uint32_t i = 0; i < record.count; ++i) {
      if (record.points[i].feature == feature) return &record.points[i];
      const Vec3 d = record.points[i].position - position;
      if (dot(d, d) < min_distance_squared) {
        min_distance_squared = dot(d, d);
        nearest = &record.points[i];
      }
    }
  }
  return nearest;
}
// Rolling impulse of a sphere, of the manifold with the same index.
Vec3 rolling_of(std::span<const PairRecord> of_pair, std::uint32_t part) {
  for (const PairRecord& record : of_pair) {
    if (record.part == part) return record.rolling;
  }
  return {};
}

bool of_one_pair(const solve::ContactConstraint& a, const solve::ContactConstraint& b) {
  return a.collider_a == b.collider_a && a.collider_b == b.collider_b;
}

// The same limit as for contact slots (solve::kTooDeep).
bool is_too_deep(const Collider& a, const Collider& b, double separation) {
  const double size = smaller_size(a, b);
  return size > 0.0 && separation < -0.5 * size;
}

// Removes from the forces' velocity change the part that contacts and joints have cancelled: it
// does not count as approach speed in later impacts.
void remove_carried(Vec3& forced, const Vec3& change) {
  const double against = -dot(forced, change), size = dot(change, change);
  if (against > 0.0) forced += std::min(1.0, against / size) * change;
}

// Maximum displacement of a contact point in a step to count as the same one [contact slops].
constexpr double kSamePoint = 20.0;

}  // namespace

// This step's record of the pair's manifold with index part.
PairRecord& World::Impl::record_of(const ColliderPair& pair, std::uint32_t part) {
  auto it = std::lower_bound(impacts.next_records.begin(), impacts.next_records.end(), pair.key,
                             [part](const PairRecord& r, std::uint64_t k) {
                               return r.key < k || (r.key == k && r.part < part);
                             });
  if (it == impacts.next_records.end() || it->key != pair.key || it->part != part) {
    PairRecord record;
    record.key = pair.key;
    record.a = pair.a;
    record.b = pair.b;
    record.part = part;
    it = impacts.next_records.insert(it, record);
  }
  return *it;
}

// Valid until the next call.
std::span<const collide::SubManifold> World::Impl::manifolds_of(const ColliderPair& pair,
                                                                double margin) {
  const Collider &a = colliders[pair.a], &b = colliders[pair.b];
  shapes.manifolds.clear();
  collide::PairCache cache;
  find_manifolds(a.geometry, a.T, b.geometry, b.T, margin, cache, {}, shapes.manifold_scratch,
                 shapes.manifolds);
  for (const collide::SubManifold& found : shapes.manifolds)
    status.distance_limit |= found.manifold.rough;
  return shapes.manifolds;
}

void World::Impl::add_contact(const ColliderPair& pair, const collide::Manifold& m,
                              std::uint32_t part, bool swept, bool warm,
                              std::vector<solve::ContactConstraint>& out) {
  const Collider &a = colliders[pair.a], &b = colliders[pair.b];
  solve::ContactConstraint& c = out.emplace_back();
  c.a = a.body;
  c.b = b.body;
  c.collider_a = pair.a;
  c.collider_b = pair.b;
  c.friction = std::sqrt(a.material.friction * b.material.friction);
  c.restitution = std::max(a.material.restitution, b.material.restitution);
  c.rolling = std::max(a.material.rolling_friction, b.material.rolling_friction);
  c.swept = swept;
  c.count = m.count;
  set_normal(c, m.normal);
  const Vec3 surface = a.T.rotate(a.surface_velocity) - b.T.rotate(b.surface_velocity);
  for (int k = 0; k < 2; ++k) c.surface_speed[k] = dot(surface, c.tangent[k]);
  for (int i = 0; i < m.count; ++i) {
    solve::ContactPoint& p = c.points[i];
    p.position = m.points[i].position;
    p.separation = m.points[i].separation;
    p.feature = m.points[i].feature;
    if (is_too_deep(a, b, p.separation)) position_error_now = true;
  }
  load_warm_start(pair.key, part, warm, c);
}

// The impulses of the last step.
void World::Impl::load_warm_start(std::uint64_t key, std::uint32_t part, bool warm,
                                  solve::ContactConstraint& c) const {
  const auto last = warm ? records_of(impacts.records, key) : std::span<const PairRecord>{};
  c.rolling_impulse = rolling_of(last, part);
  for (int i = 0; i < c.count; ++i) {
    solve::ContactPoint& p = c.points[i];
    const PairPoint* old = point_of(last, p.feature, p.position, kSamePoint * desc.contact_slop);
    p.normal_impulse = old ? old->normal_impulse : 0.0;
    p.tangent_impulse[0] = old ? dot(old->friction, c.tangent[0]) : 0.0;
    p.tangent_impulse[1] = old ? dot(old->friction, c.tangent[1]) : 0.0;
  }
}

// Before the instant is solved again: what it gave is no warm start, since its motors were too
// strong.
void World::Impl::restore_warm_starts() {
  for (solve::JointRow& row : impacts.joint_rows) {
    if (row.remember) *row.remember = row.warm_start;
  }
  std::uint32_t part = 0;
  for (std::size_t k = 0; k < impacts.contacts.size(); ++k) {
    solve::ContactConstraint& c = impacts.contacts[k];
    part = k > 0 && of_one_pair(impacts.contacts[k - 1], c) ? part + 1 : 0;
    load_warm_start(make_pair(colliders, c.collider_a, c.collider_b).key, part, true, c);
    c.consistent = true;
  }
}

void World::Impl::find_discrete_contacts(double h) {
  impacts.discrete_contacts.clear();
  for (const ColliderPair& pair : impacts.discrete_pairs) {
    const bool sensor = colliders[pair.a].sensor || colliders[pair.b].sensor;
    std::uint32_t part = 0;
    for (const auto& found : manifolds_of(pair, sensor ? 0.0 : discrete_margin(pair, h))) {
      const collide::Manifold& m = found.manifold;
      if (sensor) {
        report_sensor(pair, m.points[0].position, m.normal, 0.0);
        break;
      }
      add_contact(pair, m, part++, false, true, impacts.discrete_contacts);
    }
  }
}

void World::Impl::find_swept_contacts(bool warm) {
  for (const SweptPair& swept : impacts.swept_pairs) {
    if (swept.sensor || swept.separation > desc.contact_slop) continue;
    std::uint32_t part = 0;
    for (const auto& found : manifolds_of(swept.pair, desc.contact_slop)) {
      add_contact(swept.pair, found.manifold, part++, true, warm, impacts.contacts);
    }
  }
}

// Removes the part that the solve has cancelled from the forces' velocity changes of a body.
void World::Impl::carry(std::uint32_t body, const Vec3& change_w, const Vec3& change_v) {
  remove_carried(impacts.forced[body].w, change_w);
  remove_carried(impacts.forced[body].v, change_v);
}

void World::Impl::note_touched_articulations() {
  for (Articulation& art : articulations) art.touched = false;
  for (const solve::ContactConstraint& c : impacts.contacts) {
    for (const std::uint32_t i : {c.a, c.b}) {
      if (bodies[i].is_link) articulations[bodies[i].articulation].touched = true;
    }
  }
  note_joined_bodies();
}

RowJointStep World::Impl::row_joint_step(double h, double dt, bool first) const {
  return {first ? RowsOf::first_instant : RowsOf::impact, dt, h, 1.0, speed_unit};
}

// Solves impacts.contacts and the rows of joints. False: there are none.
bool World::Impl::solve_instant(std::span<const std::uint32_t> solved, double h, double dt,
                                bool first) {
  const RowJointStep of_joints = row_joint_step(h, dt, first);
  add_joint_rows(h, dt, of_joints.of);
  add_row_joints(of_joints);
  if (impacts.contacts.empty() && impacts.joint_rows.empty()) return false;
  refresh_solver_bodies(solved);
  begin_solve_articulations(first);
  solve::solve({impacts.solver_bodies, impacts.contacts, impacts.joint_rows, impacts.joint_pairs,
                impacts.solver_articulations, impacts.link_rows, impacts.instant, h, dt,
                desc.contact_slop, desc.restitution_threshold, desc.velocity_iterations});
  return true;
}

void World::Impl::store_implicit_impulses() {
  for (Articulation& art : articulations) {
    if (art.alive && !art.remote && !art.sub_stepped) art.store_implicit_impulses();
  }
}

// Solves all contacts at the start of a step (first), then those of the bodies that an impact
// affects.
void World::Impl::solve_contacts(double h, double dt, bool first) {
  if (!first) {
    // An impact: contacts from the start of the step take part, with zero impulses.
    for (solve::ContactConstraint& c : impacts.discrete_contacts) {
      c.rolling_impulse = {};
      for (int i = 0; i < c.count; ++i) {
        c.points[i].normal_impulse = c.points[i].tangent_impulse[0] =
            c.points[i].tangent_impulse[1] = 0.0;
      }
    }
  }
  if (first && impacts.swept_body_pairs.empty()) {  // no impact can follow that would need them
    impacts.contacts.swap(impacts.discrete_contacts);
    impacts.discrete_contacts.clear();
  } else {
    impacts.contacts.assign(impacts.discrete_contacts.begin(), impacts.discrete_contacts.end());
  }
  find_swept_contacts(first);
  const std::span<const std::uint32_t> solved =
      first ? lists.of_impacts(bodies) : impacts.concerned;
  for (const std::uint32_t i : solved) impacts.in_contact[i] = 0;
  for (const solve::ContactConstraint& c : impacts.contacts) {
    if (c.swept) impacts.in_contact[c.a] = impacts.in_contact[c.b] = 1;
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
    Body& body = bodies[i];
    if (body.is_link || body.motion != Motion::dynamic) continue;
    if (first) carry(i, impacts.solver_bodies[i].w - body.w, impacts.solver_bodies[i].v - body.v);
    body.w = impacts.solver_bodies[i].w;
    body.v = impacts.solver_bodies[i].v;
    (void)stop_if_out_of_range(context, i, impacts.start_poses[i]);
  }
  note_link_impulses(impacts.contacts);
  end_solve_articulations(first);
  if (first) store_implicit_impulses();
  take_back_row_joints(row_joint_step(h, dt, first));
  apply_corrections(solved);
  for (const solve::ContactConstraint& c : impacts.contacts) {
    counters.contacts += static_cast<std::uint32_t>(c.count);
  }
}

// A pair's manifolds are adjacent; they share its events, which are at the deepest point.
void World::Impl::report_contacts(std::span<const solve::ContactConstraint> solved, double time) {
  for (std::size_t first = 0, end = 0; first < solved.size(); first = end) {
    double impulse = 0.0, approach = 0.0, nearest = collide::kFar;
    Vec3 point, normal;
    bool hits = false;
    for (; end < solved.size() && of_one_pair(solved[first], solved[end]); ++end) {
      const solve::ContactConstraint& c = solved[end];
      for (int i = 0; i < c.count; ++i) {
        const solve::ContactPoint& p = c.points[i];
        impulse += p.normal_impulse;
        if (p.normal_impulse > 0.0) {
          approach = std::max(approach, p.approach);
          hits |= p.hits;
        }
        if (p.separation < nearest) nearest = p.separation, point = p.position, normal = c.normal;
      }
    }
    if (impulse <= 0.0 && nearest > desc.contact_slop) continue;
    const solve::ContactConstraint& c = solved[first];
    const ColliderPair pair = make_pair(colliders, c.collider_a, c.collider_b);
    PairRecord& record = record_of(pair);
    const bool known = record.touching || touches(records_of(impacts.records, pair.key));
    record.touching = true;
    if (!known)
      events.emit(colliders, ContactEvent::Kind::begin, pair, point, normal, approach, impulse,
                  time);
    if (hits)
      events.emit(colliders, ContactEvent::Kind::hit, pair, point, normal, approach, impulse, time);
  }
}

void World::Impl::report_sensor(const ColliderPair& pair, const Vec3& point, const Vec3& normal,
                                double time) {
  PairRecord& record = record_of(pair);
  const bool known = record.touching || touches(records_of(impacts.records, pair.key));
  record.touching = true;
  if (!known)
    events.emit(colliders, ContactEvent::Kind::begin, pair, point, normal, 0.0, 0.0, time);
}

// The impulses that support a load at the start of the step are the best warm start of the next.
void World::Impl::remember_impulses(std::span<const solve::ContactConstraint> solved,
                                    double scale) {
  std::uint32_t part = 0;
  for (std::size_t k = 0; k < solved.size(); ++k) {
    const solve::ContactConstraint& c = solved[k];
    part = k > 0 && of_one_pair(solved[k - 1], c) ? part + 1 : 0;
    PairRecord& record = record_of(make_pair(colliders, c.collider_a, c.collider_b), part);
    record.count = static_cast<std::uint32_t>(c.count);
    // Drops impulses outside the range of numbers, so that every snapshot can be restored.
    const Vec3 rolling = c.consistent ? scale * c.rolling_impulse : Vec3{};
    record.rolling = in_range(rolling) ? rolling : Vec3{};
    for (int i = 0; i < c.count; ++i) {
      const solve::ContactPoint& p = c.points[i];
      record.points[i] = {p.feature, 0.0, {}, in_range(p.position) ? p.position : Vec3{}};
      if (p.bounces || !c.consistent) continue;  // a bounce is no warm start
      record.points[i].normal_impulse = scale * p.normal_impulse;
      record.points[i].friction =
          scale * (p.tangent_impulse[0] * c.tangent[0] + p.tangent_impulse[1] * c.tangent[1]);
      PairPoint& cached = record.points[i];
      if (!in_range(cached.normal_impulse) || !in_range(cached.friction) ||
          !in_range(cached.position)) {
        cached = {p.feature, 0.0, {}, {}};
      }
    }
  }
}

// Ends the pairs that touched in the last step and no longer do. They may begin again in this step.
void World::Impl::report_ends() {
  for (PairRecord& last : impacts.records) {
    if (!last.touching) continue;
    if (touches(records_of(impacts.next_records, last.key))) continue;
    last.touching = false;
    events.emit(colliders, ContactEvent::Kind::end, {last.key, last.a, last.b}, {}, {}, 0.0, 0.0,
                0.0);
  }
}

}  // namespace vp
