// Regions: the bodies of a large world in groups that lie together (solve/contact_graph.h).
//
// All that go anywhere are halved by their median along the axis in which they lie farthest apart,
// then each half, until none is larger than a given number, or there are kMaxRegions. This is done
// again from time to time; in between bodies keep their region wherever they go. A body that comes
// to another takes its contacts along. Halvings keep their axes unless another is clearly better,
// and medians move little, so few bodies do.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "world/body.h"

namespace vp {

inline constexpr std::size_t kMaxRegions = 4096;
inline constexpr std::uint8_t kNoAxis = 3;  // of a halving that has not been

class Regions {
 public:
  // What steps keep of them, and snapshots hold.
  struct State {
    std::uint16_t count = 0;         // but kBetween: a power of two, or none
    std::vector<std::uint8_t> axes;  // along which each halving went, by its number
    double age = 0.0;                // since they were divided [s]
  };
  State state;

  // Divides the bodies, if it is time, into regions of at most so many. False: nothing has changed.
  bool divide(Bodies& bodies, std::span<const std::uint32_t> awake_bodies, std::size_t max_value,
              double dt);
  // Bodies that have come to another region by that, ascending.
  std::span<const std::uint32_t> changed() const { return changed_; }

  void sort(const Bodies& bodies, std::span<const std::uint32_t> awake_bodies);
  // Of a region, ascending, as they were sorted the last time.
  std::span<const std::uint32_t> awake_bodies_of(std::size_t region) const {
    return std::span(awake_).subspan(first_[region], first_[region + 1] - first_[region]);
  }

 private:
  struct Key {  // where a body is, on a grid
    std::int32_t at[3];
    std::uint32_t body;
  };
  static std::int64_t spread(std::span<const Key> keys, int axis);
  static std::uint8_t axis_of(std::span<const Key> keys, std::uint8_t before);
  void assign(Bodies& bodies, std::span<const std::uint32_t> awake_bodies);
  void halve(Bodies& bodies, std::span<Key> keys, std::size_t node);
  void set(Bodies& bodies, std::uint32_t body, std::uint16_t region);

  std::vector<std::uint32_t> awake_, first_;   // by region; where each region's begin
  std::vector<Key> keys_;                      // scratch
  std::vector<std::uint32_t> changed_, ends_;  // scratch
};

}  // namespace vp
