// The monotonic clock of this process.
#pragma once

#include <chrono>
#include <cstdint>

namespace client {

inline std::int64_t now_us() {
  using namespace std::chrono;
  return duration_cast<microseconds>(steady_clock::now().time_since_epoch()).count();
}

}  // namespace client
