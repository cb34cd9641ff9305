// Rods as the only controls of the screens.
#include "../src/gestures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vphysics/lie.h"

namespace foosball {
namespace {

struct Counted {
  int pushes = 0;
  int turns = 0;
};

class Gestures : public testing::Test {
 protected:
  Gestures() { gestures.reset(state); }

  // Moves the rod by slide and angle in this time [s].
  Counted move(int team, double slide, double angle, double seconds) {
    Counted counted;
    const int ticks = static_cast<int>(std::lround(seconds / kTick));
    state.slide_rate = slide / seconds;
    state.angle_rate = angle / seconds;
    for (int i = 0; i < ticks; ++i) {
      state.slide += slide / ticks;
      state.angle += angle / ticks;
      const Gesture gesture = gestures.update(team, state);
      counted.pushes += gesture.push ? 1 : 0;
      counted.turns += gesture.turn;
    }
    return counted;
  }
  void rest(int team) {
    state.slide_rate = state.angle_rate = 0.0;
    gestures.update(team, state);
  }

  RodState state{0, 0, 0, 0};
  RodGestures gestures;
};

TEST_F(Gestures, AStrokeAwayFromThePlayerIsOnePush) {
  for (int team = 0; team < kTeams; ++team) {
    rest(team);
    EXPECT_EQ(move(team, push_sign(team) * 0.07, 0.0, 0.2).pushes, 1);
    EXPECT_EQ(move(team, push_sign(team) * -0.07, 0.0, 0.2).pushes, 0) << "the way back";
    EXPECT_EQ(move(team, push_sign(team) * 0.07, 0.0, 0.2).pushes, 1) << "and again";
    move(team, push_sign(team) * -0.07, 0.0, 0.2);
  }
}

TEST_F(Gestures, ACreepingRodAndAShortStrokeAreNoPush) {
  rest(0);
  EXPECT_EQ(move(0, 0.07, 0.0, 2.0).pushes, 0) << "35 mm/s";
  EXPECT_EQ(move(0, -0.03, 0.0, 0.1).pushes, 0);
  EXPECT_EQ(move(0, 0.03, 0.0, 0.1).pushes, 0);
}

TEST_F(Gestures, AStrokeThatBeganBeforeTheScreenChangedDoesNotCountOnTheNewOne) {
  rest(0);
  EXPECT_EQ(move(0, 0.04, 0.0, 0.1).pushes, 1);
  gestures.reset(state);
  EXPECT_EQ(move(0, 0.06, 0.0, 0.1).pushes, 0);
}

TEST_F(Gestures, EveryThirdOfARevolutionForwardIsTheNextAndBackThePrevious) {
  const double third = 2.0 * vp::kPi / 3.0 + 0.01;
  EXPECT_EQ(move(0, 0.0, -third, 0.3).turns, 1) << "team 0 attacks +x: forward is negative";
  EXPECT_EQ(move(0, 0.0, 2.0 * third, 0.3).turns, -2);
  gestures.reset(state);
  EXPECT_EQ(move(1, 0.0, 3.0 * third, 0.3).turns, 3);
  EXPECT_EQ(move(1, 0.0, -0.9 * third, 0.3).turns, 0) << "a wrist coming back";
}

}  // namespace
}  // namespace foosball
