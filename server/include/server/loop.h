// The 1 kHz loop: absolute deadlines on the monotonic clock, real-time rights where they are given.
//
// A late tick does not shift the ones after it. Whole periods that pass while a tick overruns are
// counted as missed and left out, so that the phase stays; the match is then behind the clock by
// them, and no tick is ever stepped twice or longer.
#pragma once

#include <cstdint>
#include <functional>

#include "server/histogram.h"
#include "server/log.h"

namespace server {

struct LoopOptions {
  bool paced = true;      // false: as fast as it goes, for --fast
  bool real_time = true;  // ask for SCHED_FIFO and locked memory
  // Above the desktop and all that has no real-time priority, below the kernel's own threads that
  // carry the network and the timers (50 and 99 by default: hence between).
  int priority = 60;
  int cpu = -1;  // pin to this core; -1: any
  // Then give up the capabilities that it was started with, all but root's access to files.
  bool drop_rights = false;
};

// What the loop asks the time of and sleeps by. A test hands in one of its own.
class LoopClock {
 public:
  virtual ~LoopClock() = default;
  virtual std::int64_t now_ns() = 0;  // does not fall
  // 0, or an errno: EINTR where a signal ended it early, else it cannot wait at all.
  virtual int sleep_until(std::int64_t deadline_ns) = 0;
};
LoopClock& monotonic_clock();

struct LoopStats {
  Histogram lateness;  // of the wake-up behind its deadline [ns]
  Histogram cost;      // of one tick, from the wake-up to all but the next sleep [ns]
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

  // Calls tick(now_us, stats so far) once a period until it returns false. The calling thread gets
  // the rights; each that is refused is said in the log, and the loop runs all the same.
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
