// What a hand feels when a man of its rod hits the ball: one pulse of vibration, from the impulse
// of the hit and the material of the man. The server has one of these for phones and for the
// cabinet's controller, the client one for its gamepads: the same hit feels the same everywhere.
//
// Strength by the logarithm of the impulse, as loudness is (Weber-Fechner), over the range of play;
// weaker by half for a man from whom nothing rebounds. A soft man's contact is longer, and so is
// the pulse. No clock, no memory taken.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "cabinet/rod_input.h"

namespace cabinet {

struct HapticPulse {
  int rod = 0;            // on the table, 0..kRods-1
  float strength = 0.0f;  // 0..1 of the motor's most
  std::uint16_t ms = 0;   // kShortestPulseMs..kLongestPulseMs

  bool operator==(const HapticPulse&) const = default;
};

// A motor of the DRV2605 class, a gamepad's or a phone's needs some 15 ms to be felt at all; beyond
// 60 ms the hit is over before the hand is done with it.
inline constexpr std::uint16_t kShortestPulseMs = 15;
inline constexpr std::uint16_t kLongestPulseMs = 60;
// Softer hits are a ball that rolls along a foot. The hardest is the ball's 26 g at 23 m/s. [N s]
inline constexpr double kSoftestFelt = 0.01;
inline constexpr double kHardestFelt = 0.60;

// Of a hit of this impulse [N s] by a man of this coefficient of restitution; nothing: it is not
// felt. Numbers that are none count as none.
std::optional<HapticPulse> haptic_pulse(int rod, double impulse, double restitution);

// Bounds what a rod's motor is asked for, whatever the match brings: a ball pinched between man and
// wall hits a hundred times a second. Each rod has an account of energy (strength squared times
// time) of kPulseEnergyMs at full strength, paid back at kMeanPower: no pulse goes beyond it, and
// none weaker than one under way interrupts it.
class HapticLimiter {
 public:
  static constexpr double kMeanPower = 0.15;       // of the motor's, over minutes
  static constexpr double kPulseEnergyMs = 120.0;  // [ms] of full strength, at once

  // The pulse as it may be given, weaker where the account is low; nothing: not at all.
  std::optional<HapticPulse> admit(const HapticPulse& pulse, std::int64_t now_us);

 private:
  struct Rod {
    double spent_ms = 0.0;      // of the account, at us
    std::int64_t us = 0;        // as of when
    std::int64_t until_us = 0;  // end of the last pulse
    float strength = 0.0f;      // its strength
  };
  std::array<Rod, kRods> rods_{};
};

// Where pulses go: a cabinet's motors, a phone, a gamepad. Called from the tick: it must not wait,
// and takes no memory. With nothing attached it does nothing.
class HapticSink {
 public:
  virtual ~HapticSink() = default;
  virtual void pulse(const HapticPulse& pulse) = 0;
};

}  // namespace cabinet
