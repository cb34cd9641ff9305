// What hangs together by contacts and joints falls asleep together, and wakes together.
//
// A body is drowsy when it has been slow for sleep_after. As soon as it is, and then each
// sleep_after, it asks: all that it hangs together with is gone through, and if all of it is
// drowsy, it falls asleep. If not, those that were gone through stay drowsy, and ask again after as
// long: so one body is gone through about once in that time, and the last one that becomes drowsy
// finds the others so. Contacts are parked as they are, impulses included, so that what wakes goes
// on where it stopped.
#include <algorithm>

#include "vphysics/assert.h"
#include "world/impl.h"
#include "world/recorded_call.h"
#include "world/refuse.h"

namespace vp {

bool World::Impl::may_sleep(const Body& body) const {
  return body.allow_sleep && body.motion == Motion::dynamic && joins_sub_steps(body) &&
         !body.on_link;
}

// f(body) of all that touch it or are joined to it, some perhaps more than once.
template <class F>
void World::Impl::for_partners(std::uint32_t index, const F& f) const {
  const auto other = [index](std::uint32_t a, std::uint32_t b) { return a == index ? b : a; };
  for (std::uint32_t e = bodies[index].first_edge; e != kNone;
       e = contact_pool[e / 2].next[e % 2]) {
    const Contact& c = contact_pool[e / 2];
    if (c.place.points > 0) f(other(colliders[c.a].body, colliders[c.b].body));
  }
  for (std::uint32_t e = bodies[index].first_joint; e != kNone; e = joints[e / 2].next[e % 2]) {
    f(other(joints[e / 2].a, joints[e / 2].b));
  }
}

bool World::Impl::is_drowsy(const Body& body) const {
  return body.rest_time >= desc.sleep_after;
}

void World::Impl::watch(std::uint32_t index, double dt) {
  Body& body = bodies[index];
  if (!may_sleep(body)) return;
  const double before = body.rest_time;
  const bool slow = norm(body.v) + body.reach * norm(body.w) < desc.sleep_speed;
  body.rest_time = slow ? before + dt : 0.0;
  const bool asks_again = body.rest_time >= 2.0 * desc.sleep_after;
  if (asks_again) body.rest_time = desc.sleep_after;
  if (asks_again || (before < desc.sleep_after && body.rest_time >= desc.sleep_after)) {
    drowsy.push_back(index);
  }
}

// Into body_stack: all that the body hangs together with. False, and not all of it: some of it does
// not rest, or was found not to in an island from `first` on.
bool World::Impl::find_resting_island(std::uint32_t seed, std::uint64_t first) {
  const std::uint64_t island = ++islands_found;
  bool rests = true;
  body_stack.clear();
  const auto reach = [&](std::uint32_t index) {
    Body& body = bodies[index];
    if (body.motion == Motion::fixed || body.island == island) return;
    if (body.motion == Motion::kinematic) {
      rests = rests && body.prescribed == se3{};
      return;
    }
    rests = rests && body.island < first && may_sleep(body) && is_drowsy(body);
    body.island = island;
    body_stack.push_back(index);
  };
  reach(seed);
  for (std::size_t i = 0; i < body_stack.size() && rests; ++i) for_partners(body_stack[i], reach);
  return rests;
}

void World::Impl::send_to_sleep() {
  const std::uint64_t first = islands_found + 1;
  for (const std::uint32_t seed : drowsy) {
    if (bodies[seed].island >= first) continue;  // asleep, or gone through in vain
    if (!find_resting_island(seed, first)) {
      for (const std::uint32_t i : body_stack) {
        if (is_drowsy(bodies[i])) bodies[i].rest_time = desc.sleep_after;
      }
      continue;
    }
    for (const std::uint32_t i : body_stack) {
      Body& body = bodies[i];
      body.asleep = true;
      body.v = body.w = {};
      std::fill_n(body_rows[i + 1].velocity, 6, 0.0f);
    }
    for (const std::uint32_t i : body_stack) {
      for (std::uint32_t e = bodies[i].first_edge; e != kNone;
           e = contact_pool[e / 2].next[e % 2]) {
        park(e / 2);
      }
    }
    lists_are_stale = true;
  }
  drowsy.clear();
}

// Unless something awake may change it: a near pair of which one is awake or kinematic. A kinematic
// body that touches one asleep rests; who sets it in motion wakes the other.
void World::Impl::park(std::uint32_t index) {
  Contact& c = contact_pool[index];
  const std::uint32_t a = colliders[c.a].body, b = colliders[c.b].body;
  if (c.parked) return;
  if (c.place.points > 0) {
    const solve::Place left = c.place;
    const std::uint32_t moved = graph.park(c.place, end_of(bodies, a), end_of(bodies, b));
    if (moved != solve::kNoContact) contact_pool[moved].place = left;
    points_in_lanes -= c.count;
  } else {
    if (!is_still(bodies[a]) || !is_still(bodies[b])) return;
    const std::uint32_t place = parked_near.add(near_list, c.near_index);
    unset_near(index);
    c.near_index = place;
  }
  c.parked = true;
}

void World::Impl::unpark(std::uint32_t index) {
  Contact& c = contact_pool[index];
  if (!c.parked) return;
  if (c.place.points > 0) {
    const solve::Place left = c.place;
    const std::uint32_t moved = graph.unpark(c.place, end_of(bodies, colliders[c.a].body),
                                             end_of(bodies, colliders[c.b].body));
    if (moved != solve::kNoContact) contact_pool[moved].place = left;
    points_in_lanes += c.count;
  } else {
    const std::uint32_t place = near_list.add(parked_near, c.near_index);
    unset_near(index);
    c.near_index = place;
  }
  c.parked = false;
  if (c.stale) mark_stale(index);
}

// With all that it hangs together with.
void World::Impl::wake(std::uint32_t seed) {
  bodies[seed].rest_time = 0.0;
  if (!bodies[seed].asleep) return;
  woken.clear();
  const auto reach = [&](std::uint32_t index) {
    Body& body = bodies[index];
    if (!body.asleep) return;
    body.asleep = false;
    body.rest_time = 0.0;
    woken.push_back(index);
  };
  reach(seed);
  for (std::size_t i = 0; i < woken.size(); ++i) for_partners(woken[i], reach);
  for (const std::uint32_t i : woken) {
    if (dt_now > 0.0 && load_row(i, dt_now)) start_way_anew(i);
    for (std::uint32_t e = bodies[i].first_edge; e != kNone; e = contact_pool[e / 2].next[e % 2]) {
      unpark(e / 2);
    }
  }
  lists_are_stale = true;
}

void World::Impl::wake_neighbours(std::uint32_t index) {
  for (std::uint32_t e = bodies[index].first_edge; e != kNone;
       e = contact_pool[e / 2].next[e % 2]) {
    const Contact& c = contact_pool[e / 2];
    const std::uint32_t a = colliders[c.a].body, b = colliders[c.b].body;
    wake(a == index ? b : a);
  }
  for (std::uint32_t e = bodies[index].first_joint; e != kNone; e = joints[e / 2].next[e % 2]) {
    wake(joints[e / 2].a == index ? joints[e / 2].b : joints[e / 2].a);
  }
}

bool World::is_asleep(BodyId id) const {
  const Body* body = impl_->find(id);
  VP_ASSERT(body && "is_asleep: the body does not exist (any more)");
  return body && body->asleep;
}

Expected<void> World::wake(BodyId id) {
  if (!impl_->find(id)) return stale("wake", "the body");
  impl_->wake(id.index - 1);
  if (impl_->recorder) impl_->log({calls::Wake{id}});
  return {};
}

}  // namespace vp
