// Counts how often index marks pass their switches in a match, from the true poses.
#pragma once

#include <optional>

#include "controller.h"
#include "table.h"

namespace cabinet_bench {

struct MarkCounts {
  std::uint64_t passes = 0;              // from one side to the other, without sliding
  std::uint64_t slow = 0;                // ... slow enough for every sensor
  std::uint64_t at_stop = 0, ticks = 0;  // rod ticks with a visible mark; all rod ticks
};

class MarkWatch {
 public:
  // Call each millisecond, after the table has moved.
  void moved(const Table& table);
  const MarkCounts& counts() const { return counts_; }

 private:
  struct Entry {
    Pose at;
    double rate;  // [rad/s]
  };
  struct Rod {
    Pose last;
    bool under = false;
    std::optional<Entry> entry;
  };
  void left(const Entry& entry, const Pose& at, double rate);

  PerRod<Rod> rods_{};
  bool begun_ = false;
  MarkCounts counts_;
};

}  // namespace cabinet_bench
