#include "computer_hands.h"

#include <cstdlib>

namespace foosball {

bool ComputerHands::going_to(int line) const {
  for (int h = 0; h < count_; ++h) {
    if (hands_[h].line == line) return true;
  }
  return false;
}

bool ComputerHands::holds(int line) const {
  for (int h = 0; h < count_; ++h) {
    if (hands_[h].line == line && hands_[h].arrives_in == 0) return true;
  }
  return false;
}

void ComputerHands::leave(int line) {
  for (Hand& hand : hands_) {
    if (hand.line == line) hand = {};
  }
}

void ComputerHands::let_go() {
  hands_ = {};
}

void ComputerHands::pass_time() {
  for (Hand& hand : hands_) {
    if (hand.arrives_in > 0) --hand.arrives_in;
  }
}

void ComputerHands::want(int first, int second, const std::array<bool, 4>& busy) {
  if (first != kNone && !going_to(first)) send(first, busy, second);
  if (count_ > 1 && second != kNone && !going_to(second)) send(second, busy, first);
}

// Sends the nearest available hand: one without a rod, or one on a line that is neither requested
// nor busy.
void ComputerHands::send(int line, const std::array<bool, 4>& busy, int other) {
  Hand* best = nullptr;
  int nearest = 100;
  for (int h = 0; h < count_; ++h) {
    Hand& hand = hands_[h];
    const bool needed = hand.line != kNone && ((count_ > 1 && hand.line == other) ||
                                               busy[static_cast<std::size_t>(hand.line)]);
    const int distance = hand.line == kNone ? 10 : std::abs(hand.line - line);
    if (needed || distance >= nearest) continue;
    best = &hand;
    nearest = distance;
  }
  if (best != nullptr) *best = {line, travel_};
}

}  // namespace foosball
