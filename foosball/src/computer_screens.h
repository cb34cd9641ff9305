// How a computer player operates the screens before a match: it pushes at the logo, rotates to its
// character and confirms it. One rod does all of it.
#pragma once

#include "computer_hand.h"
#include "foosball/match.h"
#include "random.h"

namespace foosball {

class ComputerScreens {
 public:
  // The rod that operates the screens: the midfield, at the centre of the player's view.
  static constexpr int kRod = static_cast<int>(Line::midfield);

  ComputerScreens(int team, bool opens_match) : team_(team), opens_match_(opens_match) {}

  // Call once per tick before work(): draws a character when the selection appears.
  void see(const MatchView& view, double swing, Random& random);
  // True for screens that a rod operates; the others are play, or continue by themselves.
  static bool worked_at(Screen screen) {
    return screen == Screen::logo || screen == Screen::selection;
  }
  // Moves the rod on the logo and the selection. Returns false on the other screens.
  bool work(const MatchView& view, HandAxis& slide, HandAxis& swing);

 private:
  void work_selection(const MatchView& view, HandAxis& slide, HandAxis& swing);

  int team_;
  bool opens_match_;
  Screen screen_ = Screen::logo;
  int target_character_ = 0;
  double spin_to_ = 0.0;
};

}  // namespace foosball
