// Contacts with several manifolds: where one of the shapes is a mesh, a height field or a compound.
//
// The narrow phase processes the aggregate contact of such a pair when any part of it, or the
// bodies themselves, have moved by more than a small distance. Each new manifold takes over the
// contact slot of the most similar old part. So impulses persist, and colours do not change.
#include <algorithm>
#include <utility>

#include "world/contact_search.h"
#include "world/lane_fields.h"

namespace vp {
namespace {

// Min cosine between the normals of a manifold and of its predecessor.
constexpr double kSameNormal = 0.9;

// Puts the deepest point first: a contact slot for a single point takes this one.
void put_deepest_first(collide::Manifold& m) {
  const auto deeper = [](const auto& p, const auto& q) { return p.separation < q.separation; };
  std::swap(m.points[0], *std::min_element(m.points, m.points + m.count, deeper));
}

// Claims the most similar of the remaining old parts: by the sub-shapes, the number of
// common features and the normal. kNone if there is none.
std::uint32_t claim_part(const ContactStore& contacts, const Colliders& colliders,
                         std::vector<std::uint32_t>& old_parts, const collide::SubManifold& found) {
  std::uint32_t* best = nullptr;
  double best_alignment = kSameNormal;
  for (std::uint32_t& p : old_parts) {
    if (p == kNone) continue;
    const Contact& part = contacts[p];
    const auto on_surface = [&](std::uint32_t collider) {
      return is_surface(colliders[collider].geometry);
    };
    const bool same_a = part.sub_a == found.sub_a, same_b = part.sub_b == found.sub_b;
    if (!(same_a || on_surface(part.a)) || !(same_b || on_surface(part.b))) continue;
    const int lane = solve::ContactGraph::lane(part.slot);
    const Vec3 normal = part.slot.points == 1
                            ? get(contacts.graph.block<1>(part.slot).normal, lane)
                            : get(contacts.graph.block<4>(part.slot).normal, lane);
    double alike = dot(normal, found.manifold.normal) + (same_a && same_b ? 1.0 : 0.0);
    for (int i = 0; i < found.manifold.count; ++i) {
      const std::uint32_t* end = part.feature + part.count;
      if (std::find(part.feature, end, found.manifold.points[i].feature) != end) alike += 0.4;
    }
    if (alike <= best_alignment) continue;
    best_alignment = alike;
    best = &p;
  }
  if (!best) return kNone;
  const std::uint32_t claimed = *best;
  *best = kNone;
  return claimed;
}

}  // namespace

// Contacts with parts are tested by several workers at a time.
void ContactSearch::find_parts(const Contact& c, NarrowPhaseResult& found, const Approach& approach,
                               PartSearch& search) const {
  const Collider &a = s_.colliders[c.a], &b = s_.colliders[c.b];
  search.known.clear();
  for (std::uint32_t p = c.first_part; p != kNone; p = s_.contact_store[p].next_part) {
    const Contact& part = s_.contact_store[p];
    search.known.push_back({part.sub_a, part.sub_b, part.cache});
  }
  const collide::PairMotion motion = approach.motion(a, b, found.margin_at_rest);
  // A body that forces accelerate strongly does not move at its present velocity.
  const bool is_pulled = !(approach.pull_of(s_.bodies[a.body]) == Velocity{} &&
                           approach.pull_of(s_.bodies[b.body]) == Velocity{});
  const double at_rest = is_pulled ? found.margin : found.margin_at_rest;
  const collide::SearchMargin margin =
      c.sensor ? collide::SearchMargin(found.margin)
               : collide::SearchMargin(found.margin, at_rest, approach.pushed(a, b), motion);
  found.first = static_cast<std::uint32_t>(search.manifolds.size());
  collide::PairCache no_cache;  // each part has its own
  find_manifolds(a.geometry, a.T, b.geometry, b.T, margin, no_cache, search.known, search.scratch,
                 search.manifolds);
  found.count = static_cast<std::uint32_t>(search.manifolds.size()) - found.first;
  // The distance within which no contact is left out.
  const auto searched = [&](const Collider& x) {
    if (x.geometry.kind == collide::Kind::compound) return at_rest;
    return is_convex_body(x.geometry) ? margin.approach_of(x.geometry, x.T, &x == &b).touching
                                      : found.margin;
  };
  double distance = std::min(searched(a), searched(b));
  if (found.count == 0 && !c.sensor)
    distance = std::max(distance, distance_of_parts(a.geometry, a.T, b.geometry, b.T, search.cast));
  found.clearance = {distance - s_.desc.contact_slop};
}

std::span<collide::SubManifold> ContactSearch::parts_of(const NarrowPhaseResult& found) {
  return std::span(part_searches_[found.search].manifolds).subspan(found.first, found.count);
}

// Adds up what the workers have met.
void ContactSearch::note_part_searches() {
  collide::ManifoldScratch& all = s_.shapes.manifold_scratch;
  for (PartSearch& search : part_searches_) {
    all.triangles_tested += std::exchange(search.scratch.triangles_tested, 0);
    all.crowded |= std::exchange(search.scratch.crowded, false);
    all.rough |= std::exchange(search.scratch.rough, false);
    for (const collide::SubManifold& found : search.manifolds) all.rough |= found.manifold.rough;
  }
}

// As much memory for each as the largest has needed: which contacts one tests varies.
void ContactSearch::reserve_part_searches() {
  const auto level = [&](const auto& memory_of) {
    std::size_t most = 0;
    for (PartSearch& search : part_searches_) most = std::max(most, memory_of(search).capacity());
    for (PartSearch& search : part_searches_) memory_of(search).reserve(most);
  };
  level([](PartSearch & search) -> auto& { return search.known; });
  level([](PartSearch & search) -> auto& { return search.manifolds; });
  level([](PartSearch & search) -> auto& { return search.cast; });
  level([](PartSearch & search) -> auto& { return search.scratch.triangles; });
  level([](PartSearch & search) -> auto& { return search.scratch.near_triangles; });
  level([](PartSearch & search) -> auto& { return search.scratch.parts; });
  level([](PartSearch & search) -> auto& { return search.scratch.contacts; });
  level([](PartSearch & search) -> auto& { return search.scratch.planes; });
  level([](PartSearch & search) -> auto& { return search.scratch.points; });
  level([](PartSearch & search) -> auto& { return search.scratch.converged; });
}

void ContactSearch::take_over_parts(const NarrowPhaseResult& result, bool within_step) {
  const std::uint32_t index = result.contact;
  const Collider &a = s_.colliders[s_.contact_store[index].a],
                 &b = s_.colliders[s_.contact_store[index].b];
  const std::uint32_t first = s_.contact_store[index].first_part;
  if (first != kNone && s_.contact_store[first].parked) {
    wake(s_, a.body);
    wake(s_, b.body);
  }
  old_parts_.clear();
  for (std::uint32_t p = first; p != kNone; p = s_.contact_store[p].next_part)
    old_parts_.push_back(p);
  s_.contact_store.set_clearance(s_.contact_store[index], result.clearance, s_.body_set);
  const std::span<collide::SubManifold> parts = parts_of(result);
  claimed_parts_.clear();
  for (const collide::SubManifold& found : parts)
    claimed_parts_.push_back(claim_part(s_.contact_store, s_.colliders, old_parts_, found));
  std::uint32_t last = kNone;
  const auto append = [&](std::uint32_t p) {
    s_.contact_store[p].next_part = kNone;
    (last == kNone ? s_.contact_store[index].first_part : s_.contact_store[last].next_part) = p;
    last = p;
  };
  for (const std::uint32_t p : old_parts_) {
    if (p == kNone) continue;
    if (within_step) {  // its impulses are not reported yet
      append(p);
    } else {
      s_.contact_store.remove(p, s_.body_set);
    }
  }
  for (std::size_t k = 0; k < parts.size(); ++k) {
    collide::SubManifold& found = parts[k];
    std::uint32_t p = claimed_parts_[k];
    if (p == kNone) {
      Contact part;
      part.key = s_.contact_store[index].key;
      part.a = s_.contact_store[index].a;
      part.b = s_.contact_store[index].b;
      part.aggregate = index;
      part.dirty = false;
      part.sub_a = found.sub_a;
      part.sub_b = found.sub_b;
      p = s_.contact_store.add(part, s_.body_set);
    }
    Contact& part = s_.contact_store[p];
    part.sub_a = found.sub_a;
    part.sub_b = found.sub_b;
    part.cache = found.cache;
    append(p);
    put_deepest_first(found.manifold);
    assign_slot(p, found.manifold, found.to_impact);
  }
  if (last == kNone) s_.contact_store[index].first_part = kNone;
  const Contact& aggregate = s_.contact_store[index];
  if (aggregate.touching && !s_.contact_store.touches_in_parts(aggregate))
    s_.events.part_events.push_back({index, kNone, 0.0, 0.0, {}, {}});
}

}  // namespace vp
