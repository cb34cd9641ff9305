// Results and scratch memory of the narrow phase.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/manifolds.h"
#include "collide/pair_finder.h"

namespace vp {

// The result of the narrow phase for one contact.
struct NarrowPhaseResult {
  std::uint32_t contact;
  collide::Manifold manifold;
  // Search distances, with motion and at rest, and the distance that is free of contact [m].
  double margin, margin_at_rest, clearance;
  bool by_part;  // of a compound: each part has its own margin
};

// Contacts that are tested in one batch, before their results are taken over: with their colliders
// and bodies they fit into the second-level cache.
inline constexpr std::size_t kNarrowPhaseBatch = 512;

// Keeps its capacity between steps.
struct NarrowPhaseScratch {
  std::vector<collide::ProxyPair> new_pairs;
  std::vector<std::uint32_t> dirty,
      dirty_next_step;                 // contacts: of this iteration, of the next step
  std::vector<std::uint32_t> to_pose;  // bodies
  std::vector<NarrowPhaseResult> results;
  std::uint32_t renewed = 0;  // manifolds put into contact slots in this step
  // Of a contact with parts (part_contacts.cpp).
  std::vector<collide::KnownPart> known_parts;
  std::vector<std::uint32_t> old_parts, claimed_parts;
};

}  // namespace vp
