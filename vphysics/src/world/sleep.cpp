// Sleeping and waking of islands. Contacts of sleeping bodies are parked as they are, with their
// impulses, so that a waking body continues where it stopped.
#include <algorithm>

#include "vphysics/assert.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/recorded_call.h"
#include "world/restarts.h"

namespace vp {
namespace {

bool may_sleep(const Body& body) {
  return body.allow_sleep && body.motion == Motion::dynamic && joins_sub_steps(body) &&
         !body.on_link;
}

// Calls f(body) for all bodies in contact with it or joined to it, some perhaps more than once.
template <class F>
void for_partners(const IslandGraph& graph, std::uint32_t index, const F& f) {
  const auto other = [index](std::uint32_t a, std::uint32_t b) { return a == index ? b : a; };
  graph.contacts.for_each_of(graph.bodies[index], [&](std::uint32_t, const Contact& c) {
    if (c.slot.points > 0) f(other(graph.colliders[c.a].body, graph.colliders[c.b].body));
  });
  for (std::uint32_t e = graph.bodies[index].first_joint; e != kNone;
       e = graph.joints[e / 2].next[e % 2]) {
    f(other(graph.joints[e / 2].a, graph.joints[e / 2].b));
  }
}

}  // namespace

void SleepIslands::reserve(std::size_t bodies) {
  for (auto* list : {&candidates_, &island_, &woken_}) list->reserve(bodies);
}

void SleepIslands::watch(Body& body, std::uint32_t index, const WorldDesc& desc, double dt) {
  if (!may_sleep(body)) return;
  const double before = body.rest_time;
  const bool slow = norm(body.v) + body.bounding_radius * norm(body.w) < desc.sleep_speed;
  body.rest_time = slow ? before + dt : 0.0;
  const bool asks_again = body.rest_time >= 2.0 * desc.sleep_after;
  if (asks_again) body.rest_time = desc.sleep_after;
  if (asks_again || (before < desc.sleep_after && body.rest_time >= desc.sleep_after)) {
    candidates_.push_back(index);
  }
}

// Collects the island of the seed in island_. Returns false, and stops early, if a body of it does
// not rest, or belongs to an island from `first` on that does not.
bool SleepIslands::rests(const IslandGraph& graph, std::uint32_t seed, std::uint64_t first,
                         double sleep_after) {
  const std::uint64_t island = ++found_;
  bool rests = true;
  island_.clear();
  const auto visit = [&](std::uint32_t index) {
    Body& body = graph.bodies[index];
    if (body.motion == Motion::fixed || body.island == island) return;
    if (body.motion == Motion::kinematic) {
      rests = rests && body.prescribed == se3{};
      return;
    }
    rests = rests && body.island < first && may_sleep(body) && body.rest_time >= sleep_after;
    body.island = island;
    island_.push_back(index);
  };
  visit(seed);
  for (std::size_t i = 0; i < island_.size() && rests; ++i) for_partners(graph, island_[i], visit);
  if (rests) return true;
  for (const std::uint32_t i : island_) {
    double& time = graph.bodies[i].rest_time;
    time = std::min(time, sleep_after);
  }
  return false;
}

std::span<const std::uint32_t> SleepIslands::wake(const IslandGraph& graph, std::uint32_t seed) {
  woken_.clear();
  const auto visit = [&](std::uint32_t index) {
    Body& body = graph.bodies[index];
    if (!body.asleep) return;
    body.asleep = false;
    body.rest_time = 0.0;
    woken_.push_back(index);
  };
  visit(seed);
  for (std::size_t i = 0; i < woken_.size(); ++i) for_partners(graph, woken_[i], visit);
  return woken_;
}

void World::Impl::send_to_sleep() {
  for (const std::uint32_t i : lists.awake_bodies) sleep_islands.watch(bodies[i], i, desc, dt_now);
  sleep_islands.find_resting(
      context.island_graph(), desc.sleep_after, [&](std::span<const std::uint32_t> island) {
        for (const std::uint32_t i : island) {
          Body& body = bodies[i];
          body.asleep = true;
          body.v = body.w = {};
          std::fill_n(body_states[i + 1].velocity, 6, 0.0f);
        }
        for (const std::uint32_t i : island) {
          contact_store.for_each_of(bodies[i], [&](std::uint32_t contact, Contact&) {
            contact_store.park(contact, body_set);
          });
        }
        lists.invalidate();
      });
}

void wake(const Stores& s, std::uint32_t seed) {
  s.bodies[seed].rest_time = 0.0;
  if (!s.bodies[seed].asleep) return;
  const BodyStates states = s.states_in(s.dt);
  for (const std::uint32_t i : s.sleep_islands.wake(s.island_graph(), seed)) {
    if (s.dt > 0.0 && states.load(s.bodies[i], i)) restart_displacement(s, i);
    s.contact_store.for_each_of(s.bodies[i], [&](std::uint32_t contact, Contact&) {
      s.contact_store.unpark(contact, s.body_set);
    });
  }
  s.lists.invalidate();
}

void World::Impl::wake_neighbours(std::uint32_t index) {
  contact_store.for_each_of(bodies[index], [&](std::uint32_t, const Contact& c) {
    const std::uint32_t a = colliders[c.a].body, b = colliders[c.b].body;
    wake(a == index ? b : a);
  });
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
  if (!impl_->find(id)) return unknown_id("wake", "the body");
  impl_->wake(id.index - 1);
  if (impl_->recorder) impl_->log({calls::Wake{id}});
  return {};
}

}  // namespace vp
