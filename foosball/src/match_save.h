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

void save_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world,
                std::vector<std::byte>& bytes);

// Refuses bytes that are not a saved match, or one of another table, other rules or characters than
// desc; state and world are then as they were. A world of the same men is restored where it is; for
// others another takes its place.
vp::Expected<void> load_match(const MatchDesc& desc, std::span<const std::byte> bytes,
                              MatchState& state, std::unique_ptr<TableWorld>& world);

std::uint64_t hash_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world);

}  // namespace foosball
