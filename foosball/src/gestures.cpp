#include "gestures.h"

#include "vphysics/lie.h"

namespace foosball {
namespace {

// A stroke no one makes by chance while only turning a rod, and that every rod has room for from
// the middle of its slide (the shortest limit is 76 mm).
constexpr double kPushStroke = 0.035;  // [m]
// A slower hand is settling, not pushing.
constexpr double kPushRate = 0.08;  // [m/s]
// Three choices to a revolution: what a wrist turns without changing its grip.
constexpr double kTurn = 2.0 * vp::kPi / 3.0;

}  // namespace

void RodGestures::reset(const RodState& state) {
  stroke_from_ = state.slide;
  turn_from_ = state.angle;
  armed_ = false;  // a stroke that crosses a change of screen counts on the old one only
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
  // Forward is a negative angle for the team that attacks +x.
  const double forward = -attack_sign(team) * (state.angle - turn_from_);
  if (forward >= kTurn || forward <= -kTurn) {
    gesture.turn = forward > 0.0 ? 1 : -1;
    turn_from_ = state.angle;
  }
  return gesture;
}

}  // namespace foosball
