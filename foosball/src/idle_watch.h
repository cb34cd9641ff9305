// Whether a person is at the table: a hand that has moved a rod within so many ticks. Rods that a
// computer drives do not count.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "foosball/match.h"
#include "ticks.h"

namespace foosball {

class IdleWatch {
 public:
  void reset() { ticks_ = 0; }
  // One tick of the hands' targets. counts: bit i for a rod that a person may hold.
  void update(const RodTargets& hands, std::uint8_t counts) {
    count_tick(ticks_);
    for (int rod = 0; rod < kRods; ++rod) {
      const RodTarget& hand = hands[rod];
      if (!hand.live || (counts >> rod & 1u) == 0) continue;
      if (std::fabs(hand.slide - slide_[rod]) < kSlide &&
          std::fabs(hand.angle - angle_[rod]) < kAngle) {
        continue;
      }
      slide_[rod] = hand.slide;
      angle_[rod] = hand.angle;
      ticks_ = 0;
    }
  }
  std::uint64_t ticks() const { return ticks_; }  // since a hand last moved a rod

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    archive.count(self.ticks_, kMaxTicks);
    for (int rod = 0; rod < kRods; ++rod) {
      archive.real(self.slide_[rod], -kAny, kAny);
      archive.real(self.angle_[rod], -kAny, kAny);
    }
  }

 private:
  // What a sensor's noise or a table that is leant on does not reach.
  static constexpr double kSlide = 0.003;  // [m]
  static constexpr double kAngle = 0.05;   // [rad]
  static constexpr double kAny = std::numeric_limits<double>::max();

  std::uint64_t ticks_ = 0;
  std::array<double, kRods> slide_{}, angle_{};
};

}  // namespace foosball
