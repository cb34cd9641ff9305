// How far a rod has turned in one go before and after it last struck the ball (ITSF 15: more than
// 360 degrees before or after the strike is a spin; the two are not added).
#pragma once

#include <cstdint>

#include "foosball/rules.h"
#include "foosball/table.h"
#include "ticks.h"

namespace foosball {

class SpinWatch {
 public:
  // Forgets the strike and the turn under way.
  void reset(double angle);
  // One tick: the rod's angle [rad], and whether one of its men touches the ball.
  void update(double angle, bool touches);

  // The last strike was a spin, as far as is known now.
  bool spun() const { return spun_; }
  // The rod goes on turning the way it struck, so that the last strike may yet become one.
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
  // So long without progress [ticks], and the hand has stopped the rod.
  static constexpr std::uint64_t kStopTicks = 60;

  double from_ = 0.0;       // where the turn under way began [rad]
  double furthest_ = 0.0;   // and how far it has come [rad]
  double struck_at_ = 0.0;  // angle at the last strike [rad]
  std::uint64_t still_ticks_ = 0;
  bool struck_ = false;
  bool spun_ = false;
};

}  // namespace foosball
