// Regions: the bodies of a large world in spatial groups (solve/contact_graph.h).
//
// The awake bodies are split at their median along the axis of largest spread. Each half is split
// again, until no group is larger than a given number, or there are kMaxRegions. The division is
// repeated from time to time. In between, a body keeps its region wherever it moves. A body that
// changes region takes its contacts along. A split keeps its axis unless another is clearly better,
// and medians move little, so few bodies change region.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "world/body.h"

namespace vp {

inline constexpr std::size_t kMaxRegions = 4096;
inline constexpr std::uint8_t kNoAxis = 3;  // of a split that has not been made

class Regions {
 public:
  // State that persists between steps and is part of snapshots.
  struct State {
    std::uint16_t count = 0;         // without kSharedRegion: a power of two, or 0
    std::vector<std::uint8_t> axes;  // split axis of each node
    double age = 0.0;                // time since the last division [s]
  };
  State state;

  // Divides the bodies into regions of at most max_bodies, if the next division is due. False:
  // nothing has changed.
  bool divide(Bodies& bodies, std::span<const std::uint32_t> awake_bodies, std::size_t max_bodies,
              double dt);
  // Bodies that divide() has moved to another region, ascending.
  std::span<const std::uint32_t> changed() const { return changed_; }

  void sort(const Bodies& bodies, std::span<const std::uint32_t> awake_bodies);
  // The awake bodies of a region, ascending, as of the last sort().
  std::span<const std::uint32_t> awake_bodies_of(std::size_t region) const {
    return std::span(awake_).subspan(first_[region], first_[region + 1] - first_[region]);
  }

 private:
  struct Key {  // a body's position on a grid
    std::int32_t at[3];
    std::uint32_t body;
  };
  static std::int64_t spread(std::span<const Key> keys, int axis);
  static std::uint8_t axis_of(std::span<const Key> keys, std::uint8_t before);
  void assign(Bodies& bodies, std::span<const std::uint32_t> awake_bodies);
  void halve(Bodies& bodies, std::span<Key> keys, std::size_t node);
  void set(Bodies& bodies, std::uint32_t body, std::uint16_t region);

  std::vector<std::uint32_t> awake_, first_;   // by region; index of each region's first body
  std::vector<Key> keys_;                      // scratch
  std::vector<std::uint32_t> changed_, ends_;  // scratch
};

}  // namespace vp
