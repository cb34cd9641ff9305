#include "world/pair_contacts.h"

#include <algorithm>
#include <cmath>

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

// Maximum displacement of a contact point in a step to count as the same one [contact slops].
constexpr double kSamePoint = 20.0;

}  // namespace

void PairContacts::begin_step(std::size_t pairs) {
  next_records_.clear();
  records_.reserve(pairs);
  next_records_.reserve(pairs);
}

// --- to constraints ------------------------------------------------------------------------------

// Valid until the next call.
std::span<const collide::SubManifold> PairContacts::manifolds_of(const ColliderPair& pair,
                                                                 double margin) {
  const Collider &a = s_.colliders[pair.a], &b = s_.colliders[pair.b];
  s_.shapes.manifolds.clear();
  collide::PairCache cache;
  find_manifolds(a.geometry, a.T, b.geometry, b.T, margin, cache, {}, s_.shapes.manifold_scratch,
                 s_.shapes.manifolds);
  for (const collide::SubManifold& found : s_.shapes.manifolds)
    s_.status.distance_limit |= found.manifold.rough;
  return s_.shapes.manifolds;
}

void PairContacts::add(const ColliderPair& pair, double margin, bool swept, bool warm,
                       std::vector<solve::ContactConstraint>& out) {
  std::uint32_t part = 0;
  for (const collide::SubManifold& found : manifolds_of(pair, margin)) {
    solve::ContactConstraint& c = out.emplace_back();
    fill(pair, found.manifold, c);
    c.swept = swept;
    load_warm_start(pair.key, part++, warm, c);
  }
}

void PairContacts::fill(const ColliderPair& pair, const collide::Manifold& m,
                        solve::ContactConstraint& c) {
  const Collider &a = s_.colliders[pair.a], &b = s_.colliders[pair.b];
  c.a = a.body;
  c.b = b.body;
  c.collider_a = pair.a;
  c.collider_b = pair.b;
  c.friction = std::sqrt(a.material.friction * b.material.friction);
  c.restitution = std::max(a.material.restitution, b.material.restitution);
  c.rolling = std::max(a.material.rolling_friction, b.material.rolling_friction);
  c.count = m.count;
  set_normal(c, m.normal);
  const Vec3 surface = a.T.rotate(a.surface_velocity) - b.T.rotate(b.surface_velocity);
  for (int k = 0; k < 2; ++k) c.surface_speed[k] = dot(surface, c.tangent[k]);
  for (int i = 0; i < m.count; ++i) {
    solve::ContactPoint& p = c.points[i];
    p.position = m.points[i].position;
    p.separation = m.points[i].separation;
    p.feature = m.points[i].feature;
    if (is_too_deep(a, b, p.separation)) s_.position_error = true;
  }
}

// The impulses of the last step.
void PairContacts::load_warm_start(std::uint64_t key, std::uint32_t part, bool warm,
                                   solve::ContactConstraint& c) const {
  const auto last = warm ? records_of(records_, key) : std::span<const PairRecord>{};
  c.rolling_impulse = rolling_of(last, part);
  for (int i = 0; i < c.count; ++i) {
    solve::ContactPoint& p = c.points[i];
    const PairPoint* old = point_of(last, p.feature, p.position, kSamePoint * s_.desc.contact_slop);
    p.normal_impulse = old ? old->normal_impulse : 0.0;
    p.tangent_impulse[0] = old ? dot(old->friction, c.tangent[0]) : 0.0;
    p.tangent_impulse[1] = old ? dot(old->friction, c.tangent[1]) : 0.0;
  }
}

void PairContacts::reload_warm_starts(std::span<solve::ContactConstraint> contacts) const {
  std::uint32_t part = 0;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    solve::ContactConstraint& c = contacts[k];
    part = k > 0 && of_one_pair(contacts[k - 1], c) ? part + 1 : 0;
    load_warm_start(make_pair(s_.colliders, c.collider_a, c.collider_b).key, part, true, c);
    c.consistent = true;
  }
}

// --- from solved constraints ---------------------------------------------------------------------

// This step's record of the pair's manifold with index part.
PairRecord& PairContacts::record_of(const ColliderPair& pair, std::uint32_t part) {
  auto it = std::lower_bound(next_records_.begin(), next_records_.end(), pair.key,
                             [part](const PairRecord& r, std::uint64_t k) {
                               return r.key < k || (r.key == k && r.part < part);
                             });
  if (it == next_records_.end() || it->key != pair.key || it->part != part) {
    PairRecord record;
    record.key = pair.key;
    record.a = pair.a;
    record.b = pair.b;
    record.part = part;
    it = next_records_.insert(it, record);
  }
  return *it;
}

// The impulses that support a load at the start of the step are the best warm start of the next.
void PairContacts::remember(std::span<const solve::ContactConstraint> solved, double scale) {
  std::uint32_t part = 0;
  for (std::size_t k = 0; k < solved.size(); ++k) {
    const solve::ContactConstraint& c = solved[k];
    part = k > 0 && of_one_pair(solved[k - 1], c) ? part + 1 : 0;
    PairRecord& record = record_of(make_pair(s_.colliders, c.collider_a, c.collider_b), part);
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

// For contacts_of().
void PairContacts::note_contacts(std::span<const solve::ContactConstraint> solved) {
  for (const solve::ContactConstraint& c : solved) {
    for (int i = 0; i < c.count; ++i) {
      const solve::ContactPoint& p = c.points[i];
      if (p.normal_impulse <= 0.0) continue;
      s_.step_contacts.push_back(
          {s_.colliders.id(c.collider_a), s_.colliders.id(c.collider_b), p.position, c.normal,
           p.normal_impulse,
           p.tangent_impulse[0] * c.tangent[0] + p.tangent_impulse[1] * c.tangent[1]});
    }
  }
}

// A pair's manifolds are adjacent; they share its events, which are at the deepest point.
void PairContacts::report(std::span<const solve::ContactConstraint> solved, double time) {
  note_contacts(solved);
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
    if (impulse <= 0.0 && nearest > s_.desc.contact_slop) continue;
    const solve::ContactConstraint& c = solved[first];
    const ColliderPair pair = make_pair(s_.colliders, c.collider_a, c.collider_b);
    PairRecord& record = record_of(pair);
    const bool known = record.touching || touches(records_of(records_, pair.key));
    record.touching = true;
    if (!known)
      s_.events.emit(s_.colliders, ContactEvent::Kind::begin, pair, point, normal, approach,
                     impulse, time);
    if (hits)
      s_.events.emit(s_.colliders, ContactEvent::Kind::hit, pair, point, normal, approach, impulse,
                     time);
  }
}

void PairContacts::test_sensor(const ColliderPair& pair) {
  const std::span<const collide::SubManifold> found = manifolds_of(pair, 0.0);
  if (found.empty()) return;
  const collide::Manifold& m = found.front().manifold;
  report_sensor(pair, m.points[0].position, m.normal, 0.0);
}
void PairContacts::report_sensor(const ColliderPair& pair, const Vec3& point, const Vec3& normal,
                                 double time) {
  PairRecord& record = record_of(pair);
  const bool known = record.touching || touches(records_of(records_, pair.key));
  record.touching = true;
  if (!known)
    s_.events.emit(s_.colliders, ContactEvent::Kind::begin, pair, point, normal, 0.0, 0.0, time);
}

// Ends the pairs that touched in the last step and no longer do. They may begin again in this step.
void PairContacts::report_ends() {
  for (PairRecord& last : records_) {
    if (!last.touching) continue;
    if (touches(records_of(next_records_, last.key))) continue;
    last.touching = false;
    s_.events.emit(s_.colliders, ContactEvent::Kind::end, {last.key, last.a, last.b}, {}, {}, 0.0,
                   0.0, 0.0);
  }
}

void PairContacts::end_step() {
  std::erase_if(next_records_, [](const PairRecord& r) {
    bool loaded = r.touching;
    for (std::uint32_t i = 0; i < r.count; ++i) loaded |= r.points[i].normal_impulse > 0.0;
    return !loaded;
  });
  records_.swap(next_records_);
}

// --- between steps -------------------------------------------------------------------------------

void PairContacts::forget(std::uint32_t collider) {
  std::erase_if(records_, [&](const PairRecord& r) {
    if (r.a != collider && r.b != collider) return false;
    if (r.touching) {
      s_.events.destroyed.push_back({s_.colliders.id(r.a), s_.colliders.id(r.b),
                                     s_.colliders[r.a].sensor || s_.colliders[r.b].sensor});
    }
    return true;
  });
}

void PairContacts::scale(double factor) {
  for (PairRecord& record : records_) {
    record.rolling *= factor;
    for (PairPoint& point : record.points) {
      point.normal_impulse *= factor;
      point.friction *= factor;
      if (!in_range(point.normal_impulse) || !in_range(point.friction)) {
        point.normal_impulse = 0.0;
        point.friction = {};
      }
    }
    if (!in_range(record.rolling)) record.rolling = {};
  }
}

}  // namespace vp
