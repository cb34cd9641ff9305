// Terrain: heights over a regular grid. Lengths in metres.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "vphysics/error.h"
#include "vphysics/lie.h"

namespace vp {

namespace collide {
struct HeightData;
}

struct HeightGrid {
  std::uint32_t columns = 0, rows = 0;  // number of samples along x and along y, each >= 2
  double spacing_x = 1.0, spacing_y = 1.0;
  std::span<const double> heights;  // height of sample (i, j) at [j * columns + i], in metres
  // The cell between samples (i, j) and (i + 1, j + 1) is at [j * (columns - 1) + i]. A value other
  // than 0 is a hole. Empty: no holes.
  std::span<const std::uint8_t> holes;
};

// Sample (i, j) is at (i spacing_x, j spacing_y, height). Each cell has two triangles, split by the
// diagonal from (i, j) to (i + 1, j + 1). The field is solid below, as a one-sided mesh
// (triangle_mesh.h). Only for colliders of fixed and kinematic bodies. A handle: copies share the
// same constant data. Any number of colliders, worlds and threads may use it, each with its own
// scale.
class HeightField {
 public:
  // Errors: fewer than 2 or more than 2^15 columns or rows; a number of heights or holes that does
  // not match the grid; spacings outside [1e-6, 1e6] m; heights that are not finite or beyond 1e9
  // m.
  [[nodiscard]] static Expected<HeightField> of(const HeightGrid& grid);

  // The same data, scaled along the axes of the field's frame. The factors multiply the current
  // scale. Errors: factors, or products of them, outside [1e-6, 1e6].
  [[nodiscard]] Expected<HeightField> scaled(const Vec3& factors) const;

  // Precondition of all functions below: not moved from.
  const Vec3& scale() const { return scale_; }
  std::uint32_t columns() const;
  std::uint32_t rows() const;
  Vec3 sample(std::uint32_t i, std::uint32_t j) const;   // scaled; i < columns, j < rows
  bool is_hole(std::uint32_t i, std::uint32_t j) const;  // cell (i, j)
  // A contact's sub-shape is 2 (j (columns - 1) + i) for the triangle of cell (i, j) below the
  // diagonal, and one more for the triangle above it.

  // For the engine. Null if moved from.
  const std::shared_ptr<const collide::HeightData>& data() const { return data_; }

 private:
  explicit HeightField(std::shared_ptr<const collide::HeightData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collide::HeightData> data_;
  Vec3 scale_{1.0, 1.0, 1.0};
};

}  // namespace vp
