// What the narrow phase finds of contacts, and what it works with.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/manifolds.h"
#include "collide/pair_finder.h"
#include "collide/shape_query.h"

namespace vp {

// What the narrow phase has found of a contact.
struct NarrowPhaseResult {
  std::uint32_t contact;
  collide::Manifold manifold;
  // Within which it was looked for, and would be if nothing moved; free of contact for so far [m].
  double margin, margin_at_rest, clearance;
  bool by_part;  // of a compound: each part within its own margin
};

// Contacts that are looked at before any of them is taken over: with their colliders and bodies
// they fit the second-level cache.
inline constexpr std::size_t kLookedAtOnce = 512;

// Kept for its capacity.
struct NarrowPhaseScratch {
  std::vector<collide::ProxyPair> new_pairs;
  std::vector<std::uint32_t> dirty, look_again;  // contacts: in this round, in the next step
  std::vector<std::uint32_t> to_pose;            // bodies
  std::vector<NarrowPhaseResult> results;
  std::uint32_t renewed = 0;  // manifolds put into lanes in this step
  // Of a contact with parts (part_contacts.cpp).
  std::vector<collide::KnownPart> known_parts;
  std::vector<std::uint32_t> old_parts, claimed_parts;
  // Of all that look at shapes: the stage of impacts and queries too.
  std::vector<collide::SubManifold> manifolds;
  collide::ManifoldScratch manifold_scratch;
  collide::PartsScratch parts_scratch;
};

}  // namespace vp
