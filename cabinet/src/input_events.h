// Parses the events of a kernel input device (evdev). The bytes are untrusted.
#pragma once

#include <linux/input.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "cabinet/rod_input.h"

namespace cabinet {

// Splits bytes that arrive in pieces of any size into events.
class EventReader {
 public:
  void reset() { filled_ = at_ = 0; }
  // Buffer for read(), to be followed by filled(). Not empty once next() has returned false.
  std::span<std::byte> room();
  void filled(std::size_t bytes) { filled_ += bytes; }
  bool next(input_event& event);

 private:
  std::array<std::byte, 64 * sizeof(input_event)> bytes_{};
  std::size_t filled_ = 0, at_ = 0;
};

// Time of an event, on the clock of now_us. Empty if it does not lie within the last second.
std::optional<std::int64_t> stamp_of(const input_event& event, std::int64_t now_us);

struct MouseReport {
  std::int64_t right = 0, forward = 0;  // counts, at least one not 0
  std::int64_t time_us = 0;             // its time stamp, or now
};

// Sums a mouse's events to reports of motion. Events that overflowed the kernel's buffer are lost,
// and so is the report that says so.
class MouseReports {
 public:
  void reset() { *this = {}; }
  // Counts frames (reports of motion), lost, stale (no valid stamp) and latency.
  std::optional<MouseReport> take(const input_event& event, std::int64_t now_us,
                                  SourceCounters& counters);

 private:
  std::int64_t right_ = 0, forward_ = 0;  // since the last report
  bool dropped_ = false;                  // until the end of the current report
};

}  // namespace cabinet
