// The 1 kHz loop: absolute deadlines on the monotonic clock, with real-time scheduling where
// permitted.
//
// A late tick does not shift the following ticks. Full periods that pass while a tick overruns are
// counted as missed and skipped, so that the phase stays the same. The match then lags the clock by
// the missed periods. A tick is never repeated and never longer than one period.
#pragma once

#include <cstdint>
#include <functional>

#include "server/histogram.h"
#include "server/log.h"

namespace server {

struct LoopOptions {
  bool paced = true;      // false: as fast as possible, for --fast
  bool real_time = true;  // request SCHED_FIFO and locked memory
  // Above the desktop and everything without real-time priority; below the kernel threads that
  // handle the network and the timers (50 and 99 by default: hence a value between them).
  int priority = 60;
  int cpu = -1;  // pin to this core; -1: any
  // Afterwards drop the capabilities of the process, except root's access to files.
  bool drop_rights = false;
};

// The loop's clock: time and sleep. A test supplies its own.
class LoopClock {
 public:
  virtual ~LoopClock() = default;
  virtual std::int64_t now_ns() = 0;  // never decreases
  // Returns 0 or an errno. EINTR: a signal ended the sleep early; otherwise sleeping is not
  // possible.
  virtual int sleep_until(std::int64_t deadline_ns) = 0;
};
LoopClock& monotonic_clock();

struct LoopStats {
  Histogram lateness;  // of the wake-up after its deadline [ns]
  Histogram cost;      // of one tick, from the wake-up until just before the next sleep [ns]
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0;
  double seconds = 0.0;  // from the first to the last tick

  double missed_share() const {
    const auto due = ticks + missed;
    return due == 0 ? 0.0 : static_cast<double>(missed) / static_cast<double>(due);
  }
};

class TickLoop {
 public:
  static constexpr std::int64_t kPeriodNs = 1'000'000;

  TickLoop(const LoopOptions& options, Log log, LoopClock& clock = monotonic_clock());

  // Calls tick(now_us, statistics so far) once per period until it returns false. The calling
  // thread gets the real-time scheduling. If a right is denied, the log reports it and the loop
  // runs anyway.
  void run(const std::function<bool(std::int64_t now_us, const LoopStats&)>& tick);

  const LoopStats& stats() const { return stats_; }

 private:
  void ask_for_rights();
  void wait_until(std::int64_t deadline);
  std::int64_t next_deadline(std::int64_t deadline, std::int64_t now);

  LoopOptions options_;
  Log log_;
  LoopClock& clock_;
  LoopStats stats_;
  bool cannot_sleep_ = false;
};

}  // namespace server
