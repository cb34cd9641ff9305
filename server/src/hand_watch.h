// Tracks, for each source and rod, when a hand last moved it and when it was last driven. Times are
// arguments; play_us is a clock that only runs during play.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cabinet/rod_input.h"

namespace server {

class HandWatch {
 public:
  void resize(std::size_t sources) { sources_.resize(sources); }  // allocates
  // Resets all rods of the source as if they had just been moved.
  void restart(std::size_t source, std::int64_t now_us, std::int64_t play_us);
  void look(std::size_t source, const cabinet::RodInputs& rods, std::int64_t now_us,
            std::int64_t play_us);

  // Time since one of these rods (bit mask) last moved; time since one was last live.
  // Precondition: rods != 0.
  std::int64_t still_us(std::size_t source, std::uint8_t rods, std::int64_t play_us) const;
  std::int64_t undriven_us(std::size_t source, std::uint8_t rods, std::int64_t now_us) const;

 private:
  struct Rod {
    double slide = 0.0, angle = 0.0;  // pose at its last motion
    std::int64_t live_us = 0, moved_us = 0;
  };
  std::vector<std::array<Rod, cabinet::kRods>> sources_;
};

}  // namespace server
