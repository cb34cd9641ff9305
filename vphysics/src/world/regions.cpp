// Regions: the bodies of a large world in groups that lie together (solve/contact_graph.h).
//
// All that go anywhere are halved by their median along the axis in which they lie farthest apart,
// then each half, until none is larger than desc.region_bodies, or there are kMostRegions. This is
// done anew from time to time; in between bodies keep their region wherever they go. A body that
// comes to another takes its contacts along. Halvings keep their axes unless another is clearly
// better, and medians move little, so few bodies do.
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "world/impl.h"

namespace vp {
namespace {

// What falls for so long goes 0.3 m.
constexpr double kDivisionTime = 0.25;  // [s]

// Sum of the distances from the mean.
std::int64_t spread(std::span<const RegionKey> keys, int axis) {
  std::int64_t sum = 0;
  for (const RegionKey& key : keys) sum += key.at[axis];
  const std::int64_t mean = sum / static_cast<std::int64_t>(keys.size());
  std::int64_t apart = 0;
  for (const RegionKey& key : keys) apart += std::abs(key.at[axis] - mean);
  return apart;
}

// Another axis than before if along it they lie apart by a quarter more.
std::uint8_t axis_of(std::span<const RegionKey> keys, std::uint8_t before) {
  std::int64_t along[3];
  for (int axis = 0; axis < 3; ++axis) along[axis] = spread(keys, axis);
  const auto best = static_cast<std::uint8_t>(std::max_element(along, along + 3) - along);
  if (before == kNoAxis) return best;
  return 4 * (along[best] / 5) > along[before] ? best : before;
}

// How many for so many bodies, if there were `now`: a power of two, or 0 instead of one. Fewer only
// if they would not be nearly full.
std::size_t regions_for(std::size_t bodies, std::size_t most, std::size_t now) {
  std::size_t count = 1;
  while (count < kMostRegions && bodies > count * most) count *= 2;
  if (now == 2 * count && 4 * bodies > 3 * count * most) return now;
  return count > 1 ? count : 0;
}

}  // namespace

void World::Impl::divide_into_regions(double dt) {
  const std::size_t wanted =
      regions_for(movers.size(), static_cast<std::size_t>(desc.region_bodies), region_count);
  region_age = wanted == 0 ? 0.0 : region_age + dt;
  if (wanted == region_count && (wanted == 0 || region_age < kDivisionTime)) return;
  const auto before = std::exchange(region_count, static_cast<std::uint16_t>(wanted));
  region_age = 0.0;
  graph.set_regions(std::max<std::size_t>(before, region_count) + 1);
  changed_regions.clear();
  changed_regions.reserve(2 * bodies.size());
  region_keys.reserve(bodies.size());
  if (region_count != before) {
    region_axes.assign(region_count, kNoAxis);
    for (std::uint32_t i = 0; i < bodies.size(); ++i) {
      if (bodies[i].region > region_count) set_region(i, solve::kBetween);
    }
  }
  if (region_count > 0) assign_regions();
  // Halves are sets: in which order they came is the library's affair.
  std::sort(changed_regions.begin(), changed_regions.end());
  for (const std::uint32_t i : changed_regions) take_contacts_along(i);
  graph.set_regions(std::size_t{region_count} + 1);
  sort_movers_by_region();
}

void World::Impl::set_region(std::uint32_t body, std::uint16_t region) {
  if (bodies[body].region == region) return;
  bodies[body].region = region;
  changed_regions.push_back(body);
}

void World::Impl::assign_regions() {
  collide::Bounds all;
  for (const std::uint32_t i : movers) {
    const Vec3& x = bodies[i].T.position();
    all = merged(all, {x, x});
  }
  const Vec3 size = all.upper - all.lower;
  // In whole steps of a grid: their sums, and so all decisions, are the same in any order.
  const double per_metre = (1 << 30) / std::max({size.x, size.y, size.z, 1e-9});
  region_keys.clear();
  for (const std::uint32_t i : movers) {
    const Vec3 at = per_metre * (bodies[i].T.position() - all.lower);
    region_keys.push_back({{static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y),
                            static_cast<std::int32_t>(at.z)},
                           i});
  }
  halve(region_keys, 1);
}

// node: 1 is of all, 2 n and 2 n + 1 are the halves of n. Bodies at the same place go by number.
void World::Impl::halve(std::span<RegionKey> keys, std::size_t node) {
  if (keys.empty()) return;  // of the smallest regions some may have gone
  if (node >= region_count) {
    for (const RegionKey& key : keys)
      set_region(key.body, static_cast<std::uint16_t>(node - region_count + 1));
    return;
  }
  const std::uint8_t axis = region_axes[node] = axis_of(keys, region_axes[node]);
  const std::size_t middle = keys.size() / 2;
  std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(middle), keys.end(),
                   [axis](const RegionKey& a, const RegionKey& b) {
                     return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.body < b.body;
                   });
  halve(keys.first(middle), 2 * node);
  halve(keys.subspan(middle), 2 * node + 1);
}

void World::Impl::take_contacts_along(std::uint32_t body) {
  for (std::uint32_t e = bodies[body].first_edge; e != kNone; e = contact_pool[e / 2].next[e % 2]) {
    Contact& c = contact_pool[e / 2];
    if (c.place.points == 0 || c.parked) continue;
    const solve::Place left = c.place;
    const std::uint32_t moved = graph.follow(c.place, end_of(bodies, colliders[c.a].body),
                                             end_of(bodies, colliders[c.b].body));
    if (moved != solve::kNoContact) contact_pool[moved].place = left;
  }
}

// Ascending within each region.
void World::Impl::sort_movers_by_region() {
  first_of_region.assign(std::size_t{region_count} + 2, 0);
  if (region_count == 0) {
    first_of_region[1] = static_cast<std::uint32_t>(movers.size());
    movers_by_region.assign(movers.begin(), movers.end());
    return;
  }
  for (const std::uint32_t i : movers) ++first_of_region[bodies[i].region + 1u];
  for (std::size_t r = 1; r < first_of_region.size(); ++r)
    first_of_region[r] += first_of_region[r - 1];
  movers_by_region.resize(movers.size());
  region_ends.assign(first_of_region.begin(), first_of_region.end() - 1);
  for (const std::uint32_t i : movers) movers_by_region[region_ends[bodies[i].region]++] = i;
}

}  // namespace vp
