// Ground given by its height over a grid. Lengths in metres.
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
  std::uint32_t columns = 0, rows = 0;  // of samples along x and along y, each >= 2
  double spacing_x = 1.0, spacing_y = 1.0;
  std::span<const double> heights;  // of sample (i, j) at [j * columns + i], in metres
  // Of the cell between the samples (i, j) and (i + 1, j + 1) at [j * (columns - 1) + i]: other
  // than 0, there is a hole. Empty: no holes.
  std::span<const std::uint8_t> holes;
};

// Sample (i, j) lies at (i spacing_x, j spacing_y, height). Each cell is two triangles, parted by
// the diagonal from (i, j) to (i + 1, j + 1). Solid below, as a one-sided mesh (triangle_mesh.h),
// and for what does not move. A handle: copies share the same constant data, which may be used by
// any number of colliders, worlds and threads, each with its own scale.
class HeightField {
 public:
  // Refused: fewer than 2 or more than 2^15 columns or rows, another number of heights or holes
  // than the grid has, spacings that are not in [1e-6, 1e6] m, heights that are not finite or
  // beyond 1e9 m.
  [[nodiscard]] static Expected<HeightField> of(const HeightGrid& grid);

  // The same data, stretched along the axes of the field's frame; factors multiply those that it
  // has already. Refused: factors, or products of them, that are not in [1e-6, 1e6].
  [[nodiscard]] Expected<HeightField> scaled(const Vec3& factors) const;

  // Precondition of all below: not moved from.
  const Vec3& scale() const { return scale_; }
  std::uint32_t columns() const;
  std::uint32_t rows() const;
  Vec3 sample(std::uint32_t i, std::uint32_t j) const;   // scaled; i < columns, j < rows
  bool is_hole(std::uint32_t i, std::uint32_t j) const;  // of a cell
  // A contact's sub-shape is 2 (j (columns - 1) + i) of the triangle of cell (i, j) below the
  // diagonal, one more of that above it.

  // For the engine; null if moved from.
  const std::shared_ptr<const collide::HeightData>& data() const { return data_; }

 private:
  explicit HeightField(std::shared_ptr<const collide::HeightData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collide::HeightData> data_;
  Vec3 scale_{1.0, 1.0, 1.0};
};

}  // namespace vp
