// Which bodies hang together.
//
// Contacts of links are solved with their articulations' joints, to convergence, in the stage of
// impacts; so is all that is connected to a link by contacts, else a load would not be felt through
// it.
#include <algorithm>

#include "world/impl.h"

namespace vp {

bool World::Impl::is_by_impacts(const Contact& c) const {
  return c.of_link || bodies[colliders[c.a].body].by_impacts ||
         bodies[colliders[c.b].body].by_impacts;
}

void World::Impl::find_link_islands() {
  if (articulations.empty()) return;
  body_stack.clear();
  const auto reach = [this](std::uint32_t index) {
    Body& body = bodies[index];
    if (body.by_impacts || body.is_link || body.motion != Motion::dynamic) return;
    if (body.first_joint != kNone) return;  // joints are solved in sub-steps
    body.by_impacts = true;
    wake(index);
    body_stack.push_back(index);
  };
  for (Body& body : bodies) body.by_impacts = false;
  for (const Contact& c : contact_pool) {
    if (!c.alive || !c.of_link || c.sensor) continue;
    reach(colliders[c.a].body);
    reach(colliders[c.b].body);
  }
  while (!body_stack.empty()) {
    const std::uint32_t index = body_stack.back();
    body_stack.pop_back();
    for (std::uint32_t e = bodies[index].first_edge; e != kNone;
         e = contact_pool[e / 2].next[e % 2]) {
      const Contact& c = contact_pool[e / 2];
      if (c.place.points == 0 && !c.at_impacts) continue;  // near, no more
      reach(colliders[c.a].body);
      reach(colliders[c.b].body);
    }
  }
  for (std::uint32_t i = 0; i < contact_pool.size(); ++i) {
    const Contact& c = contact_pool[i];
    if (!c.alive || c.of_link || c.is_part() || is_by_impacts(c) == c.at_impacts) continue;
    c.at_impacts ? take_from_impacts(i) : give_to_impacts(i);
  }
}

// What touches goes on touching: no event tells of who solves it.
void World::Impl::give_to_impacts(std::uint32_t index) {
  Contact& c = contact_pool[index];
  c.at_impacts = true;
  if (c.has_parts) remove_parts(index);
  if (c.place.points > 0) {
    take_out_of_lane(index);
    set_near(index, 0.0);
  }
  if (!c.touching) return;
  c.touching = false;
  PairRecord record;
  record.key = c.key;
  record.a = c.a;
  record.b = c.b;
  record.touching = true;
  const auto place =
      std::lower_bound(records.begin(), records.end(), c.key,
                       [](const PairRecord& r, std::uint64_t k) { return r.key < k; });
  records.insert(place, record);
}

void World::Impl::take_from_impacts(std::uint32_t index) {
  Contact& c = contact_pool[index];
  c.at_impacts = false;
  mark_stale(index);
  const auto place =
      std::lower_bound(records.begin(), records.end(), c.key,
                       [](const PairRecord& r, std::uint64_t k) { return r.key < k; });
  auto end = place;
  for (; end != records.end() && end->key == c.key; ++end) c.touching |= end->touching;
  records.erase(place, end);
}

}  // namespace vp
