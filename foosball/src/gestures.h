// Gestures of a rod on the screens: a push (a stroke away from its player) and a turn (a third of a
// revolution, feet forward or back).
#pragma once

#include "foosball/match.h"

namespace foosball {

struct Gesture {
  bool push = false;
  int turn = 0;  // +1: feet forward, -1: back
};

class RodGestures {
 public:
  // Discards the current stroke and turn.
  void reset(const RodState& state);
  // One tick of a rod of the team.
  Gesture update(int team, const RodState& state);

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    archive.real(self.stroke_from_, -10.0, 10.0);
    archive.real(self.turn_from_, -1e9, 1e9);
    archive.flag(self.armed_);
  }

 private:
  double stroke_from_ = 0.0;  // slide at the start of the current stroke [m]
  double turn_from_ = 0.0;    // angle at the last counted turn [rad]
  bool armed_ = true;         // allows one push per stroke
};

}  // namespace foosball
