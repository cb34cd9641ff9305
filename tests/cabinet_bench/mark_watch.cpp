#include "mark_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cabinet_bench {
namespace {

constexpr double kStands = 0.5e-3;  // [m] maximum slide in a pass
constexpr double kMinTurn = 0.2;    // [rad] minimum rotation in a pass: it did not turn back
constexpr double kSlow = 4.7;       // [rad/s]: one and a half counts of a mouse per report
constexpr double kSeen = 3e-3;      // [m] from the near stop
constexpr double kMs = 1e-3;

}  // namespace

void MarkWatch::moved(const Table& table) {
  for (std::size_t i = 0; i < rods_.size(); ++i) {
    Rod& rod = rods_[i];
    const Pose& at = table.poses()[i];
    const double rate = begun_ ? std::abs(at.angle - rod.last.angle) / kMs : 0;
    const bool before = std::exchange(rod.under, table.under(i));
    if (rod.under && !before) rod.entry = Entry{at, rate};
    if (!rod.under && before) {
      if (rod.entry) left(*rod.entry, at, rate);
      rod.entry.reset();
    }
    rod.last = at;
    ++counts_.ticks;
    counts_.at_stop += std::abs(at.slide - Table::near_stop(i)) < kSeen;
  }
  begun_ = true;
}

void MarkWatch::left(const Entry& entry, const Pose& at, double rate) {
  if (std::abs(at.slide - entry.at.slide) > kStands ||
      std::abs(at.angle - entry.at.angle) < kMinTurn) {
    return;
  }
  ++counts_.passes;
  counts_.slow += std::max(rate, entry.rate) <= kSlow;
}

}  // namespace cabinet_bench
