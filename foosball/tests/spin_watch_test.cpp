#include "../src/spin_watch.h"

#include <gtest/gtest.h>

#include "vphysics/lie.h"

namespace foosball {
namespace {

constexpr double kRevolution = 2.0 * vp::kPi;

class Itsf15 : public testing::Test {
 protected:
  // Rotates the rod by this angle at a constant rate [rad/s]. strikes: it touches the ball in the
  // first tick.
  void turn(double by, bool strikes = false, double rate = 40.0) {
    const int ticks = static_cast<int>(std::fabs(by) / rate / kTick) + 1;
    for (int i = 0; i < ticks; ++i) {
      angle += by / ticks;
      watch.update(angle, strikes && i == 0);
    }
  }
  void rest(double seconds) {
    for (int i = 0; i < seconds / kTick; ++i) watch.update(angle, false);
  }
  double angle = 0.0;
  SpinWatch watch;
};

TEST_F(Itsf15, MoreThanARevolutionBeforeTheStrikeIsASpin) {
  for (const double way : {1.0, -1.0}) {
    watch.reset(angle);
    turn(way * 1.05 * kRevolution);
    EXPECT_FALSE(watch.spun()) << "a spin away from the ball is none (15.2)";
    turn(way * 0.1, true);
    EXPECT_TRUE(watch.spun());
  }
}

TEST_F(Itsf15, MoreThanARevolutionAfterTheStrikeIsASpin) {
  turn(0.5);
  turn(0.9 * kRevolution, true);
  EXPECT_FALSE(watch.spun());
  EXPECT_TRUE(watch.follows_through());
  turn(0.2 * kRevolution);
  EXPECT_TRUE(watch.spun());
}

TEST_F(Itsf15, ItIsSeenInEitherDirectionAlsoAfterALongRest) {
  for (const double way : {1.0, -1.0}) {
    rest(1.0);
    turn(way * 1.05 * kRevolution, false, 10.0);
    turn(way * 0.1, true);
    EXPECT_TRUE(watch.spun()) << way;
  }
}

TEST_F(Itsf15, BeforeAndAfterAreNotAdded) {
  turn(0.9 * kRevolution);
  turn(0.9 * kRevolution, true);
  EXPECT_FALSE(watch.spun());
}

TEST_F(Itsf15, AHandThatStopsOrTurnsBackBeginsAnew) {
  turn(0.7 * kRevolution);
  rest(0.1);
  turn(0.7 * kRevolution);
  turn(0.1, true);
  EXPECT_FALSE(watch.spun()) << "two turns with a new grip between";
  watch.reset(angle);
  turn(0.7 * kRevolution);
  turn(-0.7 * kRevolution);
  turn(0.7 * kRevolution);
  turn(0.1, true);
  EXPECT_FALSE(watch.spun()) << "to and fro";
}

TEST_F(Itsf15, ARodThatSpringsBackALittleStillTurnsTheSameWay) {
  turn(0.7 * kRevolution);
  turn(-0.2);
  turn(0.6 * kRevolution);
  turn(0.1, true);
  EXPECT_TRUE(watch.spun());
}

TEST_F(Itsf15, TheRodThatHasStoppedFollowsThroughNoMore) {
  turn(1.0, true);
  EXPECT_TRUE(watch.follows_through());
  rest(0.1);
  EXPECT_FALSE(watch.follows_through());
  turn(1.1 * kRevolution);
  EXPECT_FALSE(watch.spun()) << "a later turn is no part of the strike";
}

}  // namespace
}  // namespace foosball
