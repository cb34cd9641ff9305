// Detects which rods are moved by their hands.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "foosball/match.h"

namespace foosball {

class MovedRods {
 public:
  // One tick of the hands' targets; ignores targets that are not live. Bit i of the result: rod i
  // has moved since it was last reported.
  std::uint8_t update(const RodTargets& hands) {
    unsigned moved = 0;
    for (int rod = 0; rod < kRods; ++rod) {
      const RodTarget& hand = hands[rod];
      if (!hand.live || (std::fabs(hand.slide - slide_[rod]) < kMinHandSlide &&
                         std::fabs(hand.angle - angle_[rod]) < kMinHandTurn)) {
        continue;
      }
      slide_[rod] = hand.slide;
      angle_[rod] = hand.angle;
      moved |= 1u << rod;
    }
    return static_cast<std::uint8_t>(moved);
  }

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    for (int rod = 0; rod < kRods; ++rod) {
      archive.real(self.slide_[rod], -kAny, kAny);
      archive.real(self.angle_[rod], -kAny, kAny);
    }
  }

 private:
  static constexpr double kAny = std::numeric_limits<double>::max();

  std::array<double, kRods> slide_{}, angle_{};
};

}  // namespace foosball
