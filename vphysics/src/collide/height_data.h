// The data of a HeightField: constant once built, shared by all users of the field.
#pragma once

#include <cstdint>
#include <vector>

#include "vphysics/height_field.h"

namespace vp::collide {

struct HeightData {
  std::uint32_t columns = 0, rows = 0;
  double spacing_x = 1.0, spacing_y = 1.0;
  std::vector<double> heights;
  std::vector<std::uint8_t> holes;  // by cell; empty: no holes
  double lowest = 0.0, highest = 0.0;

  Vec3 sample(std::uint32_t i, std::uint32_t j) const {
    return {i * spacing_x, j * spacing_y, heights[std::size_t{j} * columns + i]};
  }
  // Cells beyond the border count as holes.
  bool is_hole(std::int64_t i, std::int64_t j) const {
    if (i < 0 || j < 0 || i + 1 >= columns || j + 1 >= rows) return true;
    return !holes.empty() && holes[static_cast<std::size_t>(j * (columns - 1) + i)] != 0;
  }
};

}  // namespace vp::collide
