// The monotonic clock, for the edges that live in real time: the loop, the control port's
// deadlines.
#pragma once

#include <time.h>

#include <cstdint>

namespace server {

inline std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

inline std::int64_t monotonic_us() {
  return monotonic_ns() / 1000;
}

}  // namespace server
