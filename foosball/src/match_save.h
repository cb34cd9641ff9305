// A match as bytes: description, state and world. Match::snapshot() writes them, restore() reads
// them.
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

// Fails if the bytes are not a saved match, or one with another table, rules or characters than
// desc; state and world then stay unchanged. Restores a world of the same men in place; otherwise
// replaces it by a new one.
vp::Expected<void> load_match(const MatchDesc& desc, std::span<const std::byte> bytes,
                              MatchState& state, std::unique_ptr<TableWorld>& world);

std::uint64_t hash_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world);

}  // namespace foosball
