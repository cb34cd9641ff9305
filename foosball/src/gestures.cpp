#include "gestures.h"

#include "vphysics/lie.h"

namespace foosball {
namespace {

// Too long to occur by chance while turning a rod, and possible on every rod from the centre of its
// slide (the shortest limit is 76 mm).
constexpr double kPushStroke = 0.035;  // [m]
// A slower hand is coming to rest, not pushing.
constexpr double kPushRate = 0.08;  // [m/s]
// Three choices per revolution: a wrist can turn this far without changing its grip.
constexpr double kTurn = 2.0 * vp::kPi / 3.0;

}  // namespace

void RodGestures::reset(const RodState& state) {
  stroke_from_ = state.slide;
  turn_from_ = state.angle;
  armed_ = false;  // a stroke across a change of screen counts only on the previous screen
}

Gesture RodGestures::update(int team, const RodState& state) {
  Gesture gesture;
  if (push_sign(team) * state.slide_rate < kPushRate) {
    stroke_from_ = state.slide;
    armed_ = true;
  }
  if (armed_ && push_sign(team) * (state.slide - stroke_from_) >= kPushStroke) {
    gesture.push = true;
    armed_ = false;
  }
  // Feet forward is a negative angle for the team that attacks +x.
  const double forward = -attack_sign(team) * (state.angle - turn_from_);
  if (forward >= kTurn || forward <= -kTurn) {
    gesture.turn = forward > 0.0 ? 1 : -1;
    turn_from_ = state.angle;
  }
  return gesture;
}

}  // namespace foosball
