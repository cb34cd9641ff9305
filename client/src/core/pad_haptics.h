// Haptic pulses for the people at this client when their rods hit the ball: derived from the
// snapshots' events, as the server does for phones and cabinets (cabinet/haptics.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cabinet/haptics.h"
#include "foosball/character.h"
#include "foosball/tuning.h"
#include "wire/snapshot.h"

namespace client {

class PadHaptics {
 public:
  // Pulses of the rods in this set, by bit. characters: of the match.
  std::vector<cabinet::HapticPulse> feel(std::span<const wire::EventSnapshot> events,
                                         const wire::Snapshot& scene,
                                         const foosball::Characters& characters,
                                         const foosball::Tuning& tuning, std::uint8_t rods,
                                         std::int64_t now_us);

 private:
  cabinet::HapticLimiter limiter_;
};

}  // namespace client
