#include "computer_screens.h"

#include <cmath>

namespace foosball {
namespace {

constexpr AxisLimits kCalmSlide{0.5, 8.0};
constexpr AxisLimits kCalmSwing{8.0, 80.0};

// Pushes the rod and lets it return, every two seconds until the screen changes.
void push(HandAxis& slide, double seconds) {
  const double phase = std::fmod(seconds, 2.0);
  const double goal = phase < 0.3 ? 0.0 : phase < 0.7 ? 0.06 : 0.0;
  // In the team's frame a push is towards +y for both teams.
  slide.move(goal, kCalmSlide);
}

}  // namespace

void ComputerScreens::see(const MatchView& view, double swing, Random& random) {
  if (screen_ != view.screen && view.screen == Screen::selection) {
    target_character_ = random.below(view.characters);
    spin_to_ = swing;
  }
  screen_ = view.screen;
}

bool ComputerScreens::work(const MatchView& view, HandAxis& slide, HandAxis& swing) {
  constexpr double kLookAtLogo = 0.5;  // [s]
  switch (view.screen) {
    case Screen::logo:
      if (opens_match_ && view.screen_seconds > kLookAtLogo) {
        push(slide, view.screen_seconds - kLookAtLogo);
      }
      return true;
    case Screen::selection:
      work_selection(view, slide, swing);
      return true;
    default:
      return false;
  }
}

void ComputerScreens::work_selection(const MatchView& view, HandAxis& slide, HandAxis& swing) {
  constexpr double kLookAround = 0.4;                       // [s]
  constexpr double kOneChoice = 2.0 * vp::kPi / 3.0 + 0.1;  // a little more than a third of a turn
  if (view.confirmed[team_] || view.screen_seconds < kLookAround) {
    slide.move(0.0, kCalmSlide);
    return;
  }
  if (view.character[team_] == target_character_) {
    return push(slide, view.screen_seconds - kLookAround);
  }
  const bool settled = std::fabs(swing.position() - spin_to_) < 0.01;
  if (settled) spin_to_ += kOneChoice;
  swing.move(spin_to_, kCalmSwing);
}

}  // namespace foosball
