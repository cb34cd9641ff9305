// Clocks for the parts of the program that run in real time. The epoch of the monotonic clock is
// unspecified.
#pragma once

#include <time.h>

#include <cstdint>

namespace os {

inline std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

inline std::int64_t monotonic_us() {
  return monotonic_ns() / 1000;
}

// Processor time used by this thread: time used by other processes does not count.
inline std::int64_t thread_ns() {
  timespec used{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return used.tv_sec * std::int64_t{1'000'000'000} + used.tv_nsec;
}

// Returns 0 after the sleep. EINTR: a signal ended it early. Another errno: the kernel cannot wait,
// and the call returned at once.
inline int sleep_until_ns(std::int64_t deadline_ns) {
  timespec until{};
  until.tv_sec = static_cast<time_t>(deadline_ns / 1'000'000'000);
  until.tv_nsec = static_cast<long>(deadline_ns % 1'000'000'000);
  return ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

}  // namespace os
