#include "collide/broad_phase.h"

#include <algorithm>

namespace vp::collide {

int BroadPhase::widest_axis(std::span<const Bounds> bounds) const {
  Vec3 sum, squares;
  double n = 0.0;
  for (const Bounds& b : bounds) {
    const Vec3 c = 0.5 * (b.lower + b.upper);
    // Half-spaces and empty bounds have no meaningful centre.
    if (!(norm(b.upper - b.lower) < 0.5 * kFar) || empty(b)) continue;
    n += 1.0;
    sum += c;
    squares += Vec3{c.x * c.x, c.y * c.y, c.z * c.z};
  }
  int axis = 0;
  double largest = -1.0;
  for (int i = 0; i < 3; ++i) {
    const double variance = n > 0.0 ? squares[i] - sum[i] * sum[i] / n : 0.0;
    if (variance > largest) {
      largest = variance;
      axis = i;
    }
  }
  return axis;
}

// Insertion sort: bodies move little between steps, so the old order is almost sorted.
void BroadPhase::sort_along(int axis, std::span<const Bounds> bounds) {
  const auto before = [&](std::uint32_t i, std::uint32_t j) {
    const double a = bounds[i].lower[axis], b = bounds[j].lower[axis];
    return a < b || (a == b && i < j);
  };
  for (std::size_t i = 1; i < order_.size(); ++i) {
    const std::uint32_t moving = order_[i];
    std::size_t k = i;
    for (; k > 0 && before(moving, order_[k - 1]); --k) order_[k] = order_[k - 1];
    order_[k] = moving;
  }
}

void BroadPhase::find_pairs(std::span<const Bounds> bounds, std::span<const std::uint8_t> movable,
                            std::vector<IndexPair>& pairs) {
  if (order_.size() != bounds.size()) {
    order_.resize(bounds.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    calls_ = 0;
  }
  // The sort axis affects the cost, never the pairs.
  if (calls_++ % kCallsPerAxis == 0) axis_ = widest_axis(bounds);
  const int axis = axis_;
  sort_along(axis, bounds);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const Bounds& a = bounds[order_[i]];
    if (empty(a)) continue;
    for (std::size_t j = i + 1; j < order_.size(); ++j) {
      const Bounds& b = bounds[order_[j]];
      if (b.lower[axis] > a.upper[axis]) break;
      if (empty(b) || !overlap(a, b) || !(movable[order_[i]] || movable[order_[j]])) continue;
      pairs.push_back({std::min(order_[i], order_[j]), std::max(order_[i], order_[j])});
    }
  }
  std::sort(pairs.begin(), pairs.end());
}

}  // namespace vp::collide
