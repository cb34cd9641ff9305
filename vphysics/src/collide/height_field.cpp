#include "vphysics/height_field.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "collide/height_data.h"

namespace vp {
namespace {

using collide::HeightData;

constexpr std::uint32_t kMaxSamples = 1u << 15;  // per axis
constexpr double kHighest = 1e9;                 // [m], the engine's limit
constexpr double kMinSpacing = 1e-6, kMaxSpacing = 1e6;

tl::unexpected<Error> invalid_field(std::string message) {
  return tl::make_unexpected(Error{Errc::invalid_argument, "height field: " + std::move(message)});
}

bool is_factor(double x) {
  return x >= kMinSpacing && x <= kMaxSpacing;
}

Expected<void> check(const HeightGrid& grid) {
  if (grid.columns < 2 || grid.rows < 2 || grid.columns > kMaxSamples || grid.rows > kMaxSamples) {
    return invalid_field("there must be from 2 to 2^15 columns and rows; split a larger one");
  }
  if (!is_factor(grid.spacing_x) || !is_factor(grid.spacing_y)) {
    return invalid_field("the spacing must be from 1e-6 to 1e6 m");
  }
  if (grid.heights.size() != std::size_t{grid.columns} * grid.rows) {
    return invalid_field("give columns * rows heights, " +
                         std::to_string(std::size_t{grid.columns} * grid.rows) + " of them, not " +
                         std::to_string(grid.heights.size()));
  }
  const std::size_t cells = std::size_t{grid.columns - 1} * (grid.rows - 1);
  if (!grid.holes.empty() && grid.holes.size() != cells) {
    return invalid_field("give a hole for each of the " + std::to_string(cells) +
                         " cells, (columns - 1) * (rows - 1), or none at all");
  }
  for (std::size_t k = 0; k < grid.heights.size(); ++k) {
    if (std::fabs(grid.heights[k]) <= kHighest) continue;
    return invalid_field("height " + std::to_string(k) +
                         " is not finite or beyond 1e9 m; make a hole where there is no ground");
  }
  return {};
}

}  // namespace

Expected<HeightField> HeightField::of(const HeightGrid& grid) {
  if (const Expected<void> checked = check(grid); !checked) {
    return tl::make_unexpected(checked.error());
  }
  auto field = std::make_shared<HeightData>();
  field->columns = grid.columns;
  field->rows = grid.rows;
  field->spacing_x = grid.spacing_x;
  field->spacing_y = grid.spacing_y;
  field->heights.assign(grid.heights.begin(), grid.heights.end());
  field->holes.assign(grid.holes.begin(), grid.holes.end());
  const auto [low, high] = std::minmax_element(field->heights.begin(), field->heights.end());
  field->lowest = *low;
  field->highest = *high;
  return HeightField(std::move(field));
}

Expected<HeightField> HeightField::scaled(const Vec3& factors) const {
  if (!data_) return invalid_field("it was moved from; scale the one that it was moved to");
  HeightField made = *this;
  for (int i = 0; i < 3; ++i) {
    made.scale_[i] *= factors[i];
    if (is_factor(factors[i]) && is_factor(made.scale_[i])) continue;
    return invalid_field("every factor of a scale, and what it gives, must be from 1e-6 to 1e6");
  }
  return made;
}

std::uint32_t HeightField::columns() const {
  return data_->columns;
}
std::uint32_t HeightField::rows() const {
  return data_->rows;
}
Vec3 HeightField::sample(std::uint32_t i, std::uint32_t j) const {
  const Vec3 p = data_->sample(i, j);
  return {scale_.x * p.x, scale_.y * p.y, scale_.z * p.z};
}
bool HeightField::is_hole(std::uint32_t i, std::uint32_t j) const {
  return data_->is_hole(i, j);
}

}  // namespace vp
