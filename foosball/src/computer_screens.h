// How a computer player works the screens before a match: pushes at the logo, turns to the
// character that it wants and confirms it. One rod does it all.
#pragma once

#include "computer_hand.h"
#include "foosball/match.h"
#include "random.h"

namespace foosball {

class ComputerScreens {
 public:
  // The rod that works the screens: the midfield, in the middle of what the player sees.
  static constexpr int kRod = static_cast<int>(Line::midfield);

  ComputerScreens(int team, bool opens_match) : team_(team), opens_match_(opens_match) {}

  // Call once a tick before work(): draws a character when the selection comes up.
  void see(const MatchView& view, double swing, Random& random);
  // Screens that are worked with a rod; the others are play, or go on by themselves.
  static bool worked_at(Screen screen) {
    return screen == Screen::logo || screen == Screen::selection;
  }
  // Moves the rod on the logo and the selection. False on the other screens.
  bool work(const MatchView& view, HandAxis& slide, HandAxis& swing);

 private:
  void work_selection(const MatchView& view, HandAxis& slide, HandAxis& swing);

  int team_;
  bool opens_match_;
  Screen screen_ = Screen::logo;
  int wanted_character_ = 0;
  double spin_to_ = 0.0;
};

}  // namespace foosball
