// Which rods can touch a ball: one definition for the referee, the statistics and the players.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/table.h"

namespace foosball {

// Whether any man of the rod could touch the ball, were his rod at its best slide and angle: the
// solid that his foot sweeps, a cylinder about the rod's axis, meets the ball. Source: TableSpec
// and CharacterBody alone. 0 <= rod < kRods.
bool can_reach(const TableSpec& table, int rod, const CharacterBody& body, const vp::Vec3& ball);

// Bit i: can_reach() of rod i. bodies: of team 0 and 1.
std::uint8_t rods_in_reach(const TableSpec& table, const TeamBodies& bodies, const vp::Vec3& ball);

}  // namespace foosball
