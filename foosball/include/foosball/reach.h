// Which rods can touch a ball: a single definition for the referee, the statistics and the players.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/table.h"

namespace foosball {

// True if a man of the rod could touch the ball at some slide and angle: if the solid that his foot
// sweeps, a cylinder about the rod's axis, overlaps the ball. It depends on TableSpec and
// CharacterBody only. Precondition: 0 <= rod < kRods.
bool can_reach(const TableSpec& table, int rod, const CharacterBody& body, const vp::Vec3& ball);

// Bit i: can_reach() of rod i. bodies: of teams 0 and 1.
std::uint8_t rods_in_reach(const TableSpec& table, const TeamBodies& bodies, const vp::Vec3& ball);

}  // namespace foosball
