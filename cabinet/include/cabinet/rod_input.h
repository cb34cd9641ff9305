// Input of the rods: every device delivers the latest RodInput of each rod.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace cabinet {

inline constexpr int kRods = 8;

enum class RodStatus : std::uint8_t {
  absent,  // no source drives this rod
  live,    // current
  held,    // its device is silent or unplugged: keeps the last position, rates are zero
};

struct RodInput {
  double slide = 0.0;        // along the rod [m]
  double angle = 0.0;        // about the rod [rad], unbounded
  double slide_rate = 0.0;   // [m/s]
  double angle_rate = 0.0;   // [rad/s]
  std::int64_t time_us = 0;  // time of reception, on the clock passed to poll()
  RodStatus status = RodStatus::absent;
  // Predicted part of slide and angle: the motion since the last report, extrapolated from its
  // rate.
  double slide_ahead = 0.0;  // [m]
  double angle_ahead = 0.0;  // [rad]
  bool angle_known = false;  // relative to feet straight down; else to the initial angle
};
using RodInputs = std::array<RodInput, kRods>;

// Raw counts of a rod's sensor since the first report of its device. Excludes counts from while the
// device was disconnected, and increments that are impossible for a rod.
struct RodCount {
  std::int64_t slide = 0, spin = 0;  // [counts]
};
using RodCounts = std::array<RodCount, kRods>;

// Errors in device data are counted, never asserted: the bytes are untrusted.
struct SourceCounters {
  std::uint64_t frames = 0;       // accepted
  std::uint64_t bad = 0;          // wrong length, CRC, version or range
  std::uint64_t lost = 0;         // gaps in the sequence
  std::uint64_t stale = 0;        // older than one already accepted
  std::uint64_t reopened = 0;     // times the device came back
  std::uint64_t overflows = 0;    // reports with the sensor's overflow flag set
  std::uint64_t impossible = 0;   // increments too fast for a rod: dropped
  std::uint64_t line_errors = 0;  // parity and framing errors between sensor and micro-controller
  // From arrival at this machine to the poll that reads it, where known [us].
  std::uint64_t stamped = 0, latency_sum_us = 0, latency_max_us = 0;
  // Passes of each rod's index mark more than a quarter turn from the angle by the counts.
  std::array<std::uint64_t, kRods> index_disagreements{};

  void add_latency(std::int64_t us) {
    const auto latency = static_cast<std::uint64_t>(us > 0 ? us : 0);
    ++stamped;
    latency_sum_us += latency;
    if (latency > latency_max_us) latency_max_us = latency;
  }

  SourceCounters& operator+=(const SourceCounters& b) {
    frames += b.frames;
    bad += b.bad;
    lost += b.lost;
    stale += b.stale;
    reopened += b.reopened;
    overflows += b.overflows;
    impossible += b.impossible;
    for (std::size_t rod = 0; rod < index_disagreements.size(); ++rod)
      index_disagreements[rod] += b.index_disagreements[rod];
    line_errors += b.line_errors;
    stamped += b.stamped;
    latency_sum_us += b.latency_sum_us;
    latency_max_us = latency_max_us > b.latency_max_us ? latency_max_us : b.latency_max_us;
    return *this;
  }
  friend SourceCounters operator+(SourceCounters a, const SourceCounters& b) { return a += b; }
};

class InputSource {
 public:
  virtual ~InputSource() = default;
  // Reads all input that has arrived. Never blocks. now_us: time on a monotonic clock [us].
  virtual void poll(std::int64_t now_us) = 0;
  virtual const RodInputs& rods() const = 0;
  virtual const SourceCounters& counters() const = 0;
  virtual const std::string& name() const = 0;  // for the log and the screen: "cabinet", "mouse"
};

}  // namespace cabinet
