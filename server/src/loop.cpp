#include "server/loop.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "os/capabilities.h"
#include "os/clock.h"

namespace server {
namespace {

class MonotonicClock final : public LoopClock {
 public:
  std::int64_t now_ns() override { return os::monotonic_ns(); }
  // A signal ends the sleep early, so that the tick sees the request to stop.
  int sleep_until(std::int64_t deadline_ns) override { return os::sleep_until_ns(deadline_ns); }
};

std::string because() {
  return std::string(": ") + std::strerror(errno);
}

}  // namespace

LoopClock& monotonic_clock() {
  static MonotonicClock clock;
  return clock;
}

TickLoop::TickLoop(const LoopOptions& options, Log log, LoopClock& clock)
    : options_(options), log_(std::move(log)), clock_(clock) {}

void TickLoop::ask_for_rights() {
  // Without real-time priority the kernel may delay a wake-up by 50 us; minimise that.
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  if (options_.cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(options_.cpu), &set);
    const bool pinned = ::sched_setaffinity(0, sizeof set, &set) == 0;
    log_(pinned ? LogLevel::info : LogLevel::warning,
         "core " + std::to_string(options_.cpu) + (pinned ? ": pinned" : " not given" + because()));
  }
  if (!options_.real_time) return;
  const sched_param priority{.sched_priority = options_.priority};
  // Reset on fork: threads and processes created later are ordinary ones.
  const bool fifo = ::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &priority) == 0;
  log_(fifo ? LogLevel::info : LogLevel::warning,
       fifo ? "real-time priority " + std::to_string(options_.priority)
            : "no real-time priority" + because() +
                  "; on a busy machine ticks will be late (give CAP_SYS_NICE)");
  // Locks the current mappings, which are all that a tick touches. Not future ones: with a low
  // limit, a later allocation of another thread would fail.
  const bool locked = ::mlockall(MCL_CURRENT) == 0;
  log_(locked ? LogLevel::info : LogLevel::warning,
       locked
           ? "memory locked"
           : "memory not locked" + because() + "; a page may be swapped out (give CAP_IPC_LOCK)");
}

// Skips full periods that have passed.
std::int64_t TickLoop::next_deadline(std::int64_t deadline, std::int64_t now) {
  const std::int64_t next = deadline + kPeriodNs;
  if (!options_.paced || now < next + kPeriodNs) return next;
  const std::int64_t missed = (now - next) / kPeriodNs;
  stats_.missed += static_cast<std::uint64_t>(missed);
  return next + missed * kPeriodNs;
}

// A kernel that cannot wait (an emulator, a sandbox) costs a core, but the match keeps its pace.
void TickLoop::wait_until(std::int64_t deadline) {
  const int error = clock_.sleep_until(deadline);
  if (error == 0 || error == EINTR) return;
  if (!std::exchange(cannot_sleep_, true)) {
    log_(LogLevel::warning, std::string("waiting for the clock failed: ") + std::strerror(error) +
                                "; using busy waiting, which occupies a core");
  }
  while (clock_.now_ns() < deadline) ::sched_yield();
}

void TickLoop::run(const std::function<bool(std::int64_t, const LoopStats&)>& tick) {
  if (options_.paced) ask_for_rights();
  if (options_.drop_rights) os::drop_capabilities(true);  // their purpose is fulfilled
  const std::int64_t start = clock_.now_ns();
  std::int64_t deadline = start + kPeriodNs;
  for (bool go_on = true; go_on;) {
    if (options_.paced) wait_until(deadline);
    const std::int64_t woken = clock_.now_ns();
    go_on = tick(woken / 1000, stats_);
    const std::int64_t done = clock_.now_ns();
    if (options_.paced) stats_.lateness.record(woken - deadline);
    stats_.cost.record(done - woken);
    ++stats_.ticks;
    stats_.seconds = static_cast<double>(done - start) * 1e-9;
    deadline = next_deadline(deadline, done);
  }
}

}  // namespace server
