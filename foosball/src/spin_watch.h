// Measures the rotation of a rod before and after it last struck the ball. ITSF 15: more than 360
// degrees before or after the strike is spinning; the two are not added.
#pragma once

#include <cstdint>

#include "foosball/rules.h"
#include "foosball/table.h"
#include "ticks.h"

namespace foosball {

class SpinWatch {
 public:
  // Discards the strike and the current rotation.
  void reset(double angle);
  // One tick. angle: of the rod [rad]. touches: one of its men touches the ball.
  void update(double angle, bool touches);

  // The last strike was a spin, as far as known now.
  bool spun() const { return spun_; }
  // The rod continues to rotate in the direction of its strike: the last strike may still become a
  // spin.
  bool follows_through() const { return struck_ && still_ticks_ < kStopTicks; }

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    archive.real(self.from_, -1e9, 1e9);
    archive.real(self.furthest_, -1e9, 1e9);
    archive.real(self.struck_at_, -1e9, 1e9);
    archive.count(self.still_ticks_, kMaxTicks);
    archive.flag(self.struck_);
    archive.flag(self.spun_);
  }

 private:
  // Without progress for this long [ticks], the rod has stopped.
  static constexpr std::uint64_t kStopTicks = 60;

  double from_ = 0.0;       // angle at the start of the current rotation [rad]
  double furthest_ = 0.0;   // furthest angle of the current rotation [rad]
  double struck_at_ = 0.0;  // angle at the last strike [rad]
  std::uint64_t still_ticks_ = 0;
  bool struck_ = false;
  bool spun_ = false;
};

}  // namespace foosball
