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

void ContactSearch::find_parts(const NarrowPhaseResult& look) {
  const std::uint32_t index = look.contact;
  const Collider &a = s_.colliders[s_.contact_store[index].a],
                 &b = s_.colliders[s_.contact_store[index].b];
  const std::uint32_t first = s_.contact_store[index].first_part;
  if (first != kNone && s_.contact_store[first].parked) {
    wake(s_, a.body);
    wake(s_, b.body);
  }
  known_parts_.clear();
  old_parts_.clear();
  for (std::uint32_t p = first; p != kNone; p = s_.contact_store[p].next_part) {
    const Contact& part = s_.contact_store[p];
    known_parts_.push_back({part.sub_a, part.sub_b, part.cache});
    old_parts_.push_back(p);
  }
  s_.shapes.manifolds.clear();
  const Body &body_a = s_.bodies[a.body], &body_b = s_.bodies[b.body];
  const Vec3 about = reference_point(body_b), arm = about - reference_point(body_a);
  const collide::SearchMargin by_part(look.margin, look.margin_at_rest,
                                      s_.dt * (body_b.v - body_a.v - cross(body_a.w, arm)),
                                      s_.dt * (body_b.w - body_a.w), about);
  const collide::PairMotion motion = s_.approach_in(look.dt).motion(a, b, look.margin_at_rest);
  find_manifolds(a.geometry, a.T, b.geometry, b.T,
                 look.by_part ? by_part : collide::SearchMargin(look.margin),
                 s_.contact_store[index].cache, known_parts_, s_.shapes.manifold_scratch,
                 s_.shapes.manifolds, s_.contact_store[index].sensor ? nullptr : &motion);
  for (const collide::SubManifold& found : s_.shapes.manifolds)
    s_.status.distance_limit |= found.manifold.rough;
  if (s_.contact_store[index].sensor) {
    const bool touches = !s_.shapes.manifolds.empty();
    if (touches != s_.contact_store[index].touching)
      s_.events.touch(s_.colliders, s_.contact_store[index], touches);
    return;
  }
  double clearance = look.clearance;
  if (s_.shapes.manifolds.empty()) {
    clearance = std::max(clearance, distance_of_parts(a.geometry, a.T, b.geometry, b.T,
                                                      s_.shapes.parts_scratch.cast) -
                                        s_.desc.contact_slop);
  }
  s_.contact_store.set_clearance(s_.contact_store[index], clearance, s_.body_set);
  claimed_parts_.clear();
  for (const collide::SubManifold& found : s_.shapes.manifolds)
    claimed_parts_.push_back(claim_part(s_.contact_store, s_.colliders, old_parts_, found));
  for (const std::uint32_t p : old_parts_) {
    if (p != kNone) s_.contact_store.remove(p, s_.body_set);
  }
  std::uint32_t last = kNone;
  for (std::size_t k = 0; k < s_.shapes.manifolds.size(); ++k) {
    collide::SubManifold& found = s_.shapes.manifolds[k];
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
    part.next_part = kNone;
    (last == kNone ? s_.contact_store[index].first_part : s_.contact_store[last].next_part) = p;
    last = p;
    put_deepest_first(found.manifold);
    assign_slot(p, found.manifold, found.to_impact);
  }
  if (last == kNone) s_.contact_store[index].first_part = kNone;
  const Contact& aggregate = s_.contact_store[index];
  if (aggregate.touching && !s_.contact_store.touches_in_parts(aggregate))
    s_.events.part_events.push_back({index, kNone, 0.0, 0.0, {}, {}});
}

}  // namespace vp
