// The vibration pulse that a hand feels when a man of its rod hits the ball, from the impulse of
// the hit and the man's material. The server uses it for phones and the cabinet's controller, the
// client for its gamepads: the same hit feels the same everywhere.
//
// Strength is logarithmic in the impulse over the range of play, as loudness is (Weber-Fechner). It
// is half for a man without any rebound. A soft man's contact is longer, and so is the pulse. Reads
// no clock and allocates no memory.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "cabinet/rod_input.h"

namespace cabinet {

struct HapticPulse {
  int rod = 0;            // on the table, 0..kRods-1
  float strength = 0.0f;  // fraction 0..1 of the motor's maximum
  std::uint16_t ms = 0;   // kShortestPulseMs..kLongestPulseMs

  bool operator==(const HapticPulse&) const = default;
};

// A motor of the DRV2605 class, of a gamepad or of a phone needs about 15 ms to be felt at all.
// Above 60 ms the pulse outlasts the sensation of the hit.
inline constexpr std::uint16_t kShortestPulseMs = 15;
inline constexpr std::uint16_t kLongestPulseMs = 60;
// Softer hits are a ball rolling along a foot. The hardest is the ball's 26 g at 23 m/s. [N s]
inline constexpr double kSoftestFelt = 0.01;
inline constexpr double kHardestFelt = 0.60;

// The pulse for a hit of this impulse [N s] by a man with this coefficient of restitution. Empty if
// the hit is too soft to feel, or if a value is not a number.
std::optional<HapticPulse> haptic_pulse(int rod, double impulse, double restitution);

// Bounds the load on a rod's motor, whatever the match requests: a ball pinched between man and
// wall hits a hundred times a second. Each rod has an energy budget (strength squared times time)
// of kPulseEnergyMs at full strength, refilled at kMeanPower. No pulse exceeds it, and no weaker
// pulse interrupts one in progress.
class HapticLimiter {
 public:
  static constexpr double kMeanPower = 0.15;       // fraction of the motor's power, over minutes
  static constexpr double kPulseEnergyMs = 120.0;  // [ms] at full strength, at once

  // Returns the permitted pulse, weaker if the budget is low, or nothing if none is permitted.
  std::optional<HapticPulse> admit(const HapticPulse& pulse, std::int64_t now_us);

 private:
  struct Rod {
    double spent_ms = 0.0;      // of the budget, at time `us`
    std::int64_t us = 0;        // time of spent_ms
    std::int64_t until_us = 0;  // end of the last pulse
    float strength = 0.0f;      // its strength
  };
  std::array<Rod, kRods> rods_{};
};

// Destination of pulses: a cabinet's motors, a phone, a gamepad. Called in the tick: it must not
// block or allocate memory. If nothing is connected it does nothing.
class HapticSink {
 public:
  virtual ~HapticSink() = default;
  virtual void pulse(const HapticPulse& pulse) = 0;
};

}  // namespace cabinet
