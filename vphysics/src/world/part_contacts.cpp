// Contacts with several manifolds: where one of the shapes is a mesh, a height field or a compound.
//
// The narrow phase processes the aggregate contact of such a pair when any part of it, or the
// bodies themselves, have moved by more than a small distance. Each new manifold takes over the
// contact slot of the most similar old part. So impulses persist, and colours do not change.
#include <algorithm>
#include <utility>

#include "world/impl.h"
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

void World::Impl::find_parts(const NarrowPhaseResult& look) {
  const std::uint32_t index = look.contact;
  const Collider &a = colliders[contact_store[index].a], &b = colliders[contact_store[index].b];
  const std::uint32_t first = contact_store[index].first_part;
  if (first != kNone && contact_store[first].parked) {
    wake(a.body);
    wake(b.body);
  }
  narrow.known_parts.clear();
  narrow.old_parts.clear();
  for (std::uint32_t p = first; p != kNone; p = contact_store[p].next_part) {
    const Contact& part = contact_store[p];
    narrow.known_parts.push_back({part.sub_a, part.sub_b, part.cache});
    narrow.old_parts.push_back(p);
  }
  shapes.manifolds.clear();
  const Body &body_a = bodies[a.body], &body_b = bodies[b.body];
  const Vec3 about = reference_point(body_b), arm = about - reference_point(body_a);
  const collide::SearchMargin by_part(look.margin, look.margin_at_rest,
                                      dt_now * (body_b.v - body_a.v - cross(body_a.w, arm)),
                                      dt_now * (body_b.w - body_a.w), about);
  find_manifolds(
      a.geometry, a.T, b.geometry, b.T, look.by_part ? by_part : collide::SearchMargin(look.margin),
      contact_store[index].cache, narrow.known_parts, shapes.manifold_scratch, shapes.manifolds);
  for (const collide::SubManifold& found : shapes.manifolds) note_limits(found.manifold);
  if (contact_store[index].sensor) {
    const bool touches = !shapes.manifolds.empty();
    if (touches != contact_store[index].touching)
      events.touch(colliders, contact_store[index], touches);
    return;
  }
  double clearance = look.clearance;
  if (shapes.manifolds.empty()) {
    clearance = std::max(
        clearance, distance_of_parts(a.geometry, a.T, b.geometry, b.T, shapes.parts_scratch.cast) -
                       desc.contact_slop);
  }
  contact_store.set_clearance(contact_store[index], clearance, body_set);
  narrow.claimed_parts.clear();
  for (const collide::SubManifold& found : shapes.manifolds)
    narrow.claimed_parts.push_back(claim_part(contact_store, colliders, narrow.old_parts, found));
  for (const std::uint32_t p : narrow.old_parts) {
    if (p != kNone) contact_store.remove(p, body_set);
  }
  std::uint32_t last = kNone;
  for (std::size_t k = 0; k < shapes.manifolds.size(); ++k) {
    collide::SubManifold& found = shapes.manifolds[k];
    std::uint32_t p = narrow.claimed_parts[k];
    if (p == kNone) {
      Contact part;
      part.key = contact_store[index].key;
      part.a = contact_store[index].a;
      part.b = contact_store[index].b;
      part.aggregate = index;
      part.dirty = false;
      part.sub_a = found.sub_a;
      part.sub_b = found.sub_b;
      p = contact_store.add(part, body_set);
    }
    Contact& part = contact_store[p];
    part.sub_a = found.sub_a;
    part.sub_b = found.sub_b;
    part.cache = found.cache;
    part.next_part = kNone;
    (last == kNone ? contact_store[index].first_part : contact_store[last].next_part) = p;
    last = p;
    put_deepest_first(found.manifold);
    assign_slot(p, found.manifold);
  }
  if (last == kNone) contact_store[index].first_part = kNone;
  const Contact& aggregate = contact_store[index];
  if (aggregate.touching && !contact_store.touches_in_parts(aggregate))
    events.part_events.push_back({index, kNone, 0.0, 0.0, {}, {}});
}

}  // namespace vp
