// What an input device of the kernel (evdev) sends, taken apart: bytes are a stranger's.
#pragma once

#include <linux/input.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "cabinet/rod_input.h"

namespace cabinet {

// Cuts bytes that come in pieces of any size into events.
class EventReader {
 public:
  void reset() { filled_ = at_ = 0; }
  // To be read into, and then told of by filled(); never empty once next() has said no.
  std::span<std::byte> room();
  void filled(std::size_t bytes) { filled_ += bytes; }
  bool next(input_event& event);

 private:
  std::array<std::byte, 64 * sizeof(input_event)> bytes_{};
  std::size_t filled_ = 0, at_ = 0;
};

// When it happened, on the clock of now_us; none if that is of no time between the last second and
// now.
std::optional<std::int64_t> stamp_of(const input_event& event, std::int64_t now_us);

struct MouseReport {
  std::int64_t right = 0, forward = 0;  // counts, one of them not 0
  std::int64_t time_us = 0;             // its stamp, or now
};

// Adds a mouse's events up to reports of motion. What a kernel's buffer did not hold is lost, and
// so is the report in which it says so.
class MouseReports {
 public:
  void reset() { *this = {}; }
  // Counts frames (reports of motion), lost, stale (no stamp) and latency.
  std::optional<MouseReport> take(const input_event& event, std::int64_t now_us,
                                  SourceCounters& counters);

 private:
  std::int64_t right_ = 0, forward_ = 0;  // since the last report
  bool dropped_ = false;                  // until the report that comes after
};

}  // namespace cabinet
