// A pass by a computer player to a chosen man of its team.
#pragma once

namespace foosball {

// Indices into TableSpec::rods.
struct PlayedPass {
  int from_rod = -1, to_rod = -1, to_man = -1;  // to_rod < 0: none
};

}  // namespace foosball
