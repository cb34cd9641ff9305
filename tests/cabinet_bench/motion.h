// Motions of single rods, one after the other, as a builder performs them at the bench. Records
// what the controller sends, as `head -c ... /dev/ttyACM0 > FILE` would.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller.h"
#include "table.h"

namespace cabinet_bench {

struct Motion {
  std::size_t rod = 0;  // from 0
  double slide = 0;     // [m]
  double turns = 0;     // right-handed about +y
};
// "6:252:-5": rod 6 (from 1) by 252 mm and five turns.
std::optional<Motion> motion_of(const std::string& text);

// All sensors are initialised first, which is not recorded.
std::vector<std::uint8_t> record_motions(Controller& controller, Table& table,
                                         const std::vector<Motion>& motions);

}  // namespace cabinet_bench
