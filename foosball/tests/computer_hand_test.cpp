// The sight and the hand of a computer player stay within a person's limits.
#include "../src/computer_hand.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../src/classic_tactics.h"
#include "../src/computer_sight.h"

namespace foosball {
namespace {

TEST(HandAxis, ArrivesWithoutOvershootAndWithinItsLimits) {
  const AxisLimits limits{2.0, 40.0};
  HandAxis axis;
  axis.adopt(0.0);
  double before = 0.0;
  for (int tick = 0; tick < 400; ++tick) {
    axis.move(0.2, limits);
    EXPECT_LE(std::fabs(axis.rate()), limits.rate + 1e-12);
    EXPECT_LE(std::fabs(axis.rate() - before), limits.acceleration * kTick + 1e-12);
    EXPECT_LE(axis.position(), 0.2 + 1e-3);
    before = axis.rate();
  }
  EXPECT_NEAR(axis.position(), 0.2, 1e-4);
  EXPECT_NEAR(axis.rate(), 0.0, 1e-2);
}

TEST(ComputerSight, SeesNothingNewBeforeItsDelayIsOver) {
  ComputerSight sight(0, 100);
  MatchView view;
  view.ball_in_play = true;
  view.layout = Layout::tournament;
  for (int tick = 0; tick < 150; ++tick) sight.look(view);
  view.ball_position.x = 0.3;
  for (int tick = 0; tick < 99; ++tick) {
    sight.look(view);
    ASSERT_EQ(sight.now().ball.x, 0.0) << tick;
  }
  sight.look(view);
  EXPECT_EQ(sight.now().ball.x, 0.3);
}

TEST(ComputerSight, TurnsTheTableForTeamOne) {
  ComputerSight sight(1, 1);
  MatchView view;
  view.ball_position = {0.4, -0.1, 0.02};
  view.ball_velocity = {-1.0, 2.0, 0.0};
  view.rods[6] = {0.05, 0.3, 0.0, 0.0};
  sight.look(view);
  EXPECT_DOUBLE_EQ(sight.now().ball.x, -0.4);
  EXPECT_DOUBLE_EQ(sight.now().ball.y, 0.1);
  EXPECT_DOUBLE_EQ(sight.now().velocity.x, 1.0);
  EXPECT_DOUBLE_EQ(sight.now().slide[6], -0.05);
  EXPECT_DOUBLE_EQ(sight.now().swing[6], 0.3) << "feet towards -x are forward for team 1";
}

TEST(YAfter, ReflectsAtTheSideWalls) {
  const TableSpec& table = table_spec(Layout::paper);
  const double wall = 0.5 * table.width - table.ball_radius;
  EXPECT_NEAR(y_after(table, 0.0, 1.0, 0.1), 0.1, 1e-12);
  EXPECT_NEAR(y_after(table, 0.0, 1.0, wall + 0.1), wall - 0.1, 1e-12);
  EXPECT_NEAR(y_after(table, 0.0, -1.0, 3.0 * wall + 0.1), wall - 0.1, 1e-12);
  EXPECT_NEAR(y_after(table, 0.1, -50.0, 4.0 * wall / 50.0), 0.1, 1e-9);
}

TEST(ClassicTemper, SharpIsBetterInEverythingButNoBetterThanAPerson) {
  const Temper sharp = temper_of(1.0), sleepy = temper_of(0.0), absurd = temper_of(1e9);
  EXPECT_LT(sharp.delay, sleepy.delay);
  EXPECT_LT(sharp.aim_error, sleepy.aim_error);
  EXPECT_GT(sharp.strike.rate, sleepy.strike.rate);
  EXPECT_LE(absurd.strike.rate, 140.0);
  EXPECT_GE(absurd.delay, 0.05);
}

}  // namespace
}  // namespace foosball
