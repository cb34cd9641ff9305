// Where rods come from: every device, however different, ends as the latest RodInput of each rod.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace cabinet {

inline constexpr int kRods = 8;

enum class RodStatus : std::uint8_t {
  absent,  // nobody drives this rod
  live,    // fresh
  held,    // its device fell silent or was unplugged: the last position stands, rates are zero
};

struct RodInput {
  double slide = 0.0;        // along the rod [m]
  double angle = 0.0;        // about the rod [rad], unbounded
  double slide_rate = 0.0;   // [m/s]
  double angle_rate = 0.0;   // [rad/s]
  std::int64_t time_us = 0;  // when it was received, on the clock handed to poll()
  RodStatus status = RodStatus::absent;
  // Of slide and angle, what no report has said yet: the motion since the last one, by its rate.
  double slide_ahead = 0.0;  // [m]
  double angle_ahead = 0.0;  // [rad]
};
using RodInputs = std::array<RodInput, kRods>;

// What a rod's sensor has counted since its device was first heard, before calibration. Of what
// came while the device was away, and of what no rod can do, nothing.
struct RodCount {
  std::int64_t slide = 0, spin = 0;  // [counts]
};
using RodCounts = std::array<RodCount, kRods>;

// Counted, never asserted: bytes from a device are a stranger's.
struct SourceCounters {
  std::uint64_t frames = 0;       // accepted
  std::uint64_t bad = 0;          // wrong length, CRC, version or range
  std::uint64_t lost = 0;         // gaps in the sequence
  std::uint64_t stale = 0;        // older than one already accepted
  std::uint64_t reopened = 0;     // times the device came back
  std::uint64_t overflows = 0;    // reports in which a sensor said it had moved too far to tell
  std::uint64_t impossible = 0;   // increments of a rod that no rod can make: dropped
  std::uint64_t line_errors = 0;  // parity and framing errors between sensor and micro-controller
  // From the arrival at this machine to the poll that takes it in, where that is known [us].
  std::uint64_t stamped = 0, latency_sum_us = 0, latency_max_us = 0;

  void add_latency(std::int64_t us) {
    const auto latency = static_cast<std::uint64_t>(us > 0 ? us : 0);
    ++stamped;
    latency_sum_us += latency;
    if (latency > latency_max_us) latency_max_us = latency;
  }

  friend SourceCounters operator+(const SourceCounters& a, const SourceCounters& b) {
    return {a.frames + b.frames,
            a.bad + b.bad,
            a.lost + b.lost,
            a.stale + b.stale,
            a.reopened + b.reopened,
            a.overflows + b.overflows,
            a.impossible + b.impossible,
            a.line_errors + b.line_errors,
            a.stamped + b.stamped,
            a.latency_sum_us + b.latency_sum_us,
            a.latency_max_us > b.latency_max_us ? a.latency_max_us : b.latency_max_us};
  }
};

class InputSource {
 public:
  virtual ~InputSource() = default;
  // Takes in all that has arrived. Never blocks. now_us: a monotonic clock [us], handed in.
  virtual void poll(std::int64_t now_us) = 0;
  virtual const RodInputs& rods() const = 0;
  virtual const SourceCounters& counters() const = 0;
  virtual const std::string& name() const = 0;  // for the log and the screen: "cabinet", "mouse"
};

}  // namespace cabinet
