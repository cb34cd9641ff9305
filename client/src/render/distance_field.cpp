#include "render/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace client {
namespace {

constexpr float kFar = 1e10f;

// One line of the transform, in place: f(p) becomes min over q of (p - q)^2 + f(q).
class LineTransform {
 public:
  explicit LineTransform(int longest)
      : value_(static_cast<std::size_t>(longest)),
        place_(static_cast<std::size_t>(longest)),
        border_(static_cast<std::size_t>(longest) + 1) {}

  void run(float* f, int count, int stride) {
    int last = 0;
    place_[0] = 0;
    border_[0] = -std::numeric_limits<float>::infinity();
    border_[1] = std::numeric_limits<float>::infinity();
    for (int q = 0; q < count; ++q) value_[static_cast<std::size_t>(q)] = f[q * stride];
    for (int q = 1; q < count; ++q) {
      float s = meeting(q, place_[static_cast<std::size_t>(last)]);
      while (s <= border_[static_cast<std::size_t>(last)]) {
        --last;
        s = meeting(q, place_[static_cast<std::size_t>(last)]);
      }
      ++last;
      place_[static_cast<std::size_t>(last)] = q;
      border_[static_cast<std::size_t>(last)] = s;
      border_[static_cast<std::size_t>(last) + 1] = std::numeric_limits<float>::infinity();
    }
    for (int q = 0, k = 0; q < count; ++q) {
      while (border_[static_cast<std::size_t>(k) + 1] < static_cast<float>(q)) ++k;
      const int p = place_[static_cast<std::size_t>(k)];
      f[q * stride] = static_cast<float>((q - p) * (q - p)) + value_[static_cast<std::size_t>(p)];
    }
  }

 private:
  // Abscissa of the intersection of the parabolas over q and p.
  float meeting(int q, int p) const {
    const float height = value_[static_cast<std::size_t>(q)] - value_[static_cast<std::size_t>(p)];
    return (height + static_cast<float>(q * q - p * p)) / static_cast<float>(2 * (q - p));
  }

  std::vector<float> value_;
  std::vector<int> place_;
  std::vector<float> border_;
};

// Squared distances to the nearest zero of the grid.
void transform(std::vector<float>& grid, int width, int height) {
  LineTransform line(std::max(width, height));
  for (int x = 0; x < width; ++x) line.run(grid.data() + x, height, width);
  for (int y = 0; y < height; ++y) line.run(grid.data() + y * width, width, 1);
}

}  // namespace

std::vector<std::uint8_t> distance_field(std::span<const std::uint8_t> coverage, int width,
                                         int height, int step, float reach) {
  std::vector<float> to_inside(coverage.size()), to_outside(coverage.size());
  // The coverage of a pixel on the outline gives the distance from its centre to the outline.
  const auto squared = [](float d) { return d > 0.0f ? d * d : 0.0f; };
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    const float covered = static_cast<float>(coverage[i]) / 255.0f;
    to_inside[i] = coverage[i] == 0 ? kFar : squared(0.5f - covered);
    to_outside[i] = coverage[i] == 255 ? kFar : squared(covered - 0.5f);
  }
  transform(to_inside, width, height);
  transform(to_outside, width, height);
  std::vector<std::uint8_t> field;
  field.reserve(coverage.size() / static_cast<std::size_t>(step * step));
  for (int y = step / 2; y < height; y += step) {
    for (int x = step / 2; x < width; x += step) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x);
      const float distance = std::sqrt(to_outside[i]) - std::sqrt(to_inside[i]);
      field.push_back(static_cast<std::uint8_t>(
          std::lround(std::clamp(128.0f + 127.0f * distance / reach, 0.0f, 255.0f))));
    }
  }
  return field;
}

}  // namespace client
