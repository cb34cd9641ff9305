// Checks after each second of ticks how many ticks were missed in it.
#pragma once

#include <cstdint>

namespace server {

class OverloadWatch {
 public:
  enum class Change : std::uint8_t { none, overloaded, keeps_up_again };

  static constexpr std::uint64_t kWindow = 1000;  // ticks
  static constexpr std::uint64_t kTolerated = 50;

  // Both count from the start. Call each tick.
  Change look(std::uint64_t ticks, std::uint64_t missed) {
    if (ticks - ticks_ < kWindow) return Change::none;
    const bool overloaded = missed - missed_ > kTolerated;
    ticks_ = ticks;
    missed_ = missed;
    if (overloaded == overloaded_) return Change::none;
    overloaded_ = overloaded;
    return overloaded ? Change::overloaded : Change::keeps_up_again;
  }

 private:
  std::uint64_t ticks_ = 0, missed_ = 0;
  bool overloaded_ = false;
};

}  // namespace server
