// Motions of single rods, one after the other, as a maker does them at the bench: what the
// controller sends meanwhile is what `head -c ... /dev/ttyACM0 > FILE` would keep.
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

// All sensors are set up first, which is not recorded.
std::vector<std::uint8_t> record_motions(Controller& controller, Table& table,
                                         const std::vector<Motion>& motions);

}  // namespace cabinet_bench
