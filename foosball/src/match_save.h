// A match as bytes: description, state and world. What Match::snapshot() writes and restore()
// reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "match_state.h"
#include "table_world.h"

namespace foosball {

struct SavedMatch {
  MatchState state;
  std::unique_ptr<TableWorld> world;
};

void save_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world,
                std::vector<std::byte>& bytes);

// Refuses bytes that are not a saved match, or one of another table or other rules than desc.
vp::Expected<SavedMatch> load_match(const MatchDesc& desc, std::span<const std::byte> bytes);

std::uint64_t hash_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world);

}  // namespace foosball
