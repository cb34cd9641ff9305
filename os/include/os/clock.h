// The clocks for the edges that live in real time. The monotonic one begins at some moment of the
// past.
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

// Processor time that this thread has used: what other processes take does not count.
inline std::int64_t thread_ns() {
  timespec used{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return used.tv_sec * std::int64_t{1'000'000'000} + used.tv_nsec;
}

// 0, or why it returned early: EINTR, a signal came; else the kernel refuses to wait, and returned
// at once.
inline int sleep_until_ns(std::int64_t deadline_ns) {
  timespec until{};
  until.tv_sec = static_cast<time_t>(deadline_ns / 1'000'000'000);
  until.tv_nsec = static_cast<long>(deadline_ns % 1'000'000'000);
  return ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

}  // namespace os
