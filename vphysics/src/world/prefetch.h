// Requests data ahead of its use. Contacts, colliders and bodies are met in an order that has
// nothing to do with their order in memory, and a large world does not fit into the caches: without
// this, a stage waits for memory most of its time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "world/step_context.h"

namespace vp {

// g++ removes calls of functions that do nothing else, so all of these are inlined.
template <class T>
[[gnu::always_inline]] inline void prefetch(const T& object, std::size_t cache_lines) {
  for (std::size_t i = 0; i < cache_lines; ++i)
    __builtin_prefetch(reinterpret_cast<const char*>(&object) + 64 * i);
}

// The first lines of a body or collider: its geometry, poses and velocities. None if the index is
// that of nothing, as a contact that no longer exists may have.
template <class Slots>
[[gnu::always_inline]] inline void prefetch_slot(const Slots& slots, std::uint32_t index) {
  constexpr std::size_t kLines = 4;
  if (index < slots.size()) prefetch(slots[index], kLines);
}

// In a loop over contacts, before the contact k < end: contact_at(k) is its index. Each stage reads
// what an earlier one has requested.
template <class ContactAt>
[[gnu::always_inline]] inline void prefetch_contacts(const Stores& s, const ContactAt& contact_at,
                                                     std::size_t k, std::size_t end) {
  constexpr std::size_t kStage = 3;  // contacts
  if (k + 3 * kStage < end) prefetch(s.contact_store[contact_at(k + 3 * kStage)], 3);
  if (k + 2 * kStage < end) {
    const Contact& c = s.contact_store[contact_at(k + 2 * kStage)];
    prefetch_slot(s.colliders, c.a);
    prefetch_slot(s.colliders, c.b);
  }
  if (k + kStage < end) {
    const Contact& c = s.contact_store[contact_at(k + kStage)];
    for (const std::uint32_t collider : {c.a, c.b}) {
      if (collider < s.colliders.size()) prefetch_slot(s.bodies, s.colliders[collider].body);
    }
  }
}

// In the same loop, if it sets the clearances of contacts without points: what that reads and
// writes, apart from the above.
template <class ContactAt>
[[gnu::always_inline]] inline void prefetch_clearances(const Stores& s, const ContactAt& contact_at,
                                                       std::size_t k, std::size_t end) {
  constexpr std::size_t kStage = 3;  // contacts
  if (k + kStage >= end) return;
  const Contact& c = s.contact_store[contact_at(k + kStage)];
  if (c.slot.points > 0 || c.parked) return;
  prefetch(s.contact_store.speculative.pair(c.speculative_index), 2);
  for (const std::uint32_t collider : {c.a, c.b}) {
    const std::uint32_t body = s.colliders[collider].body;
    if (body + 1u < s.body_states.size()) prefetch(s.body_states[body + 1u], 1);
  }
}

// The same in a loop over bodies that poses their colliders. body_at(k) is kNone if the loop skips
// k.
template <class BodyAt>
[[gnu::always_inline]] inline void prefetch_bodies(const Stores& s, const BodyAt& body_at,
                                                   std::size_t k, std::size_t end) {
  constexpr std::size_t kStage = 4, kColliderLines = 7;
  if (k + 2 * kStage < end) prefetch_slot(s.bodies, body_at(k + 2 * kStage));
  if (k + kStage >= end) return;
  const std::uint32_t body = body_at(k + kStage);
  const std::uint32_t collider = body < s.bodies.size() ? s.bodies[body].first_collider : kNone;
  if (collider != kNone) prefetch(s.colliders[collider], kColliderLines);
}

}  // namespace vp
