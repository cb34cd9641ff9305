#include "world/regions.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vp {
namespace {

// Free fall covers 0.3 m in this time.
constexpr double kDivisionTime = 0.25;  // [s]

// Number of regions for a number of bodies, given the current number `now`: a power of two, or 0
// instead of 1. It decreases only if the fewer regions would be at most three quarters full.
std::size_t regions_for(std::size_t bodies, std::size_t max_bodies, std::size_t now) {
  std::size_t count = 1;
  while (count < kMaxRegions && bodies > count * max_bodies) count *= 2;
  if (now == 2 * count && 4 * bodies > 3 * count * max_bodies) return now;
  return count > 1 ? count : 0;
}

}  // namespace

// Sum of the distances from the mean.
std::int64_t Regions::spread(std::span<const Key> keys, int axis) {
  std::int64_t sum = 0;
  for (const Key& key : keys) sum += key.at[axis];
  const std::int64_t mean = sum / static_cast<std::int64_t>(keys.size());
  std::int64_t separation = 0;
  for (const Key& key : keys) separation += std::abs(key.at[axis] - mean);
  return separation;
}

// Changes the axis only if the spread along another one is larger by a quarter.
std::uint8_t Regions::axis_of(std::span<const Key> keys, std::uint8_t before) {
  std::int64_t along[3];
  for (int axis = 0; axis < 3; ++axis) along[axis] = spread(keys, axis);
  const auto best = static_cast<std::uint8_t>(std::max_element(along, along + 3) - along);
  if (before == kNoAxis) return best;
  return 4 * (along[best] / 5) > along[before] ? best : before;
}

bool Regions::divide(Bodies& bodies, std::span<const std::uint32_t> awake_bodies,
                     std::size_t max_bodies, double dt) {
  const std::size_t target = regions_for(awake_bodies.size(), max_bodies, state.count);
  state.age = target == 0 ? 0.0 : state.age + dt;
  if (target == state.count && (target == 0 || state.age < kDivisionTime)) return false;
  const auto before = std::exchange(state.count, static_cast<std::uint16_t>(target));
  state.age = 0.0;
  changed_.clear();
  changed_.reserve(2 * bodies.size());
  keys_.reserve(bodies.size());
  if (state.count != before) {
    state.axes.assign(state.count, kNoAxis);
    for (std::uint32_t i = 0; i < bodies.size(); ++i) {
      if (bodies[i].region > state.count) set(bodies, i, solve::kSharedRegion);
    }
  }
  if (state.count > 0) assign(bodies, awake_bodies);
  // std::nth_element does not define the order within the halves.
  std::sort(changed_.begin(), changed_.end());
  return true;
}

void Regions::set(Bodies& bodies, std::uint32_t body, std::uint16_t region) {
  if (bodies[body].region == region) return;
  bodies[body].region = region;
  changed_.push_back(body);
}

void Regions::assign(Bodies& bodies, std::span<const std::uint32_t> awake_bodies) {
  collide::Bounds all;
  for (const std::uint32_t i : awake_bodies) {
    const Vec3& x = bodies[i].T.position();
    all = merged(all, {x, x});
  }
  const Vec3 size = all.upper - all.lower;
  // Integer grid coordinates: their sums, and so all decisions, do not depend on the order.
  const double per_metre = (1 << 30) / std::max({size.x, size.y, size.z, 1e-9});
  keys_.clear();
  for (const std::uint32_t i : awake_bodies) {
    const Vec3 at = per_metre * (bodies[i].T.position() - all.lower);
    keys_.push_back({{static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y),
                      static_cast<std::int32_t>(at.z)},
                     i});
  }
  halve(bodies, keys_, 1);
}

// node: 1 is the root, 2 n and 2 n + 1 are the halves of n. Bodies at the same position are ordered
// by index.
void Regions::halve(Bodies& bodies, std::span<Key> keys, std::size_t node) {
  if (keys.empty()) return;  // too few bodies: some regions stay empty
  if (node >= state.count) {
    for (const Key& key : keys)
      set(bodies, key.body, static_cast<std::uint16_t>(node - state.count + 1));
    return;
  }
  const std::uint8_t axis = state.axes[node] = axis_of(keys, state.axes[node]);
  const std::size_t half = keys.size() / 2;
  std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(half), keys.end(),
                   [axis](const Key& a, const Key& b) {
                     return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.body < b.body;
                   });
  halve(bodies, keys.first(half), 2 * node);
  halve(bodies, keys.subspan(half), 2 * node + 1);
}

// Bodies are ascending within each region.
void Regions::sort(const Bodies& bodies, std::span<const std::uint32_t> awake_bodies) {
  first_.assign(std::size_t{state.count} + 2, 0);
  if (state.count == 0) {
    first_[1] = static_cast<std::uint32_t>(awake_bodies.size());
    awake_.assign(awake_bodies.begin(), awake_bodies.end());
    return;
  }
  for (const std::uint32_t i : awake_bodies) ++first_[bodies[i].region + 1u];
  for (std::size_t r = 1; r < first_.size(); ++r) first_[r] += first_[r - 1];
  awake_.resize(awake_bodies.size());
  ends_.assign(first_.begin(), first_.end() - 1);
  for (const std::uint32_t i : awake_bodies) awake_[ends_[bodies[i].region]++] = i;
}

}  // namespace vp
