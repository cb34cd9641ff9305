#include "../src/referee.h"

#include <gtest/gtest.h>

namespace foosball {
namespace {

const TableSpec& table = table_spec(Layout::tournament);
constexpr double kLine = 0.6;

TEST(Goal, CountsOnlyOnceTheBallHasWhollyPassedTheLine) {
  const double r = table.ball_radius;
  EXPECT_EQ(goal_by(table, {kLine, 0, r}), std::nullopt) << "half over the line";
  EXPECT_EQ(goal_by(table, {kLine + r - 1e-6, 0, r}), std::nullopt);
  EXPECT_EQ(goal_by(table, {kLine + r + 1e-6, 0, r}), 0);
  EXPECT_EQ(goal_by(table, {-kLine - r - 1e-6, 0, r}), 1) << "team 0 defends -x";
}

TEST(Goal, IsOnlyInsideTheOpening) {
  EXPECT_EQ(goal_by(table, {0.65, 0.11, 0.02}), std::nullopt);
  EXPECT_EQ(goal_by(table, {0.65, 0.0, 0.09}), std::nullopt);
  EXPECT_EQ(goal_by(table, {0.65, 0.10, 0.02}), 0);
}

TEST(OutOfTable, IsOverAWallOrBelowTheFieldButNotInAGoal) {
  EXPECT_FALSE(out_of_table(table, {0, 0, 0.5})) << "high over the field it may fall back";
  EXPECT_FALSE(out_of_table(table, {0.65, 0.0, 0.02}));
  EXPECT_TRUE(out_of_table(table, {0.0, 0.341, 0.15}));
  EXPECT_TRUE(out_of_table(table, {-0.61, 0.0, 0.15})) << "over the goal";
  EXPECT_TRUE(out_of_table(table, {0.65, 0.2, 0.02}));
  EXPECT_TRUE(out_of_table(table, {0.75, 0.0, 0.02})) << "behind the goal box";
  EXPECT_TRUE(out_of_table(table, {0, 0, -0.001}));
}

TEST(Winner, NeedsFiveGoalsAndTwoMoreThanTheOtherButNeverMoreThanEight) {
  const Rules rules;
  EXPECT_EQ(winner(rules, {4, 0}), std::nullopt);
  EXPECT_EQ(winner(rules, {5, 3}), 0);
  EXPECT_EQ(winner(rules, {4, 5}), std::nullopt);
  EXPECT_EQ(winner(rules, {4, 6}), 1);
  EXPECT_EQ(winner(rules, {6, 7}), std::nullopt);
  EXPECT_EQ(winner(rules, {7, 7}), std::nullopt);
  EXPECT_EQ(winner(rules, {7, 8}), 1) << "the most there is";
}

TEST(Winner, WithOneGoalAtMostIsTheFirstToScore) {
  Rules rules;
  rules.goals_to_win = rules.max_goals = 1;
  EXPECT_EQ(winner(rules, {0, 0}), std::nullopt);
  EXPECT_EQ(winner(rules, {0, 1}), 1);
}

TEST(DeadBallPlace, IsTheNearestDefenceOrTheServersMidfieldBetweenTheMidfields) {
  const auto place = [](double x, int server) {
    return table.rods[rod_for_dead_ball(table, x, server)];
  };
  EXPECT_EQ(place(-0.5, 1).line, Line::defence);
  EXPECT_EQ(place(-0.5, 1).team, 0);
  EXPECT_EQ(place(0.3, 0).line, Line::defence);
  EXPECT_EQ(place(0.3, 0).team, 1);
  for (int server = 0; server < kTeams; ++server) {
    EXPECT_EQ(place(0.01, server).line, Line::midfield);
    EXPECT_EQ(place(0.01, server).team, server);
  }
}

TEST(BallTouches, AnEndWithoutABeginningLeavesTheOthersTouching) {
  BallTouches touches;
  touches.set(3, 2, 0, true);
  touches.set(3, 2, 1, false);
  touches.set(0, 0, 0, false);
  EXPECT_TRUE(touches.any());
  touches.set(3, 2, 0, false);
  EXPECT_FALSE(touches.any());
}

TEST(BallTouches, APartThatBeganTwiceEndsOnce) {
  BallTouches touches;
  touches.set(kRods - 1, kMaxMenOnRod - 1, kManParts - 1, true);
  touches.set(kRods - 1, kMaxMenOnRod - 1, kManParts - 1, true);
  touches.set(kRods - 1, kMaxMenOnRod - 1, kManParts - 1, false);
  EXPECT_FALSE(touches.any());
}

// Ticks until the watch calls a ball at rest dead, at most limit.
int ticks_until_dead(const vp::Vec3& ball, bool touched, int limit) {
  DeadBallWatch watch;
  watch.reset(ball);
  for (int tick = 1; tick <= limit; ++tick) {
    if (watch.update(table, Rules{}, ball, touched)) return tick;
  }
  return limit + 1;
}

TEST(DeadBall, IsCalledAfterSixSecondsUntouchedAtRest) {
  EXPECT_NEAR(ticks_until_dead({0.0, 0.1, 0.0173}, false, 20000), 6000, 1);
}

TEST(DeadBall, AHeldBallHasTenSecondsOnTheMidfieldAndFifteenElsewhere) {
  EXPECT_NEAR(ticks_until_dead({-0.075, 0.0, 0.0173}, true, 20000), 10000, 1);
  EXPECT_NEAR(ticks_until_dead({-0.375, 0.0, 0.0173}, true, 20000), 15000, 1);
}

TEST(DeadBall, ABallThatKeepsGoingToAndFroIsAlive) {
  DeadBallWatch watch;
  watch.reset({});
  for (int tick = 0; tick < 60000; ++tick) {
    const double x = (tick / 4000) % 2 == 0 ? 0.3 : -0.3;
    ASSERT_FALSE(watch.update(table, Rules{}, {x, 0.0, 0.0173}, false)) << tick;
  }
}

TEST(DeadBall, ATouchGivesSixSecondsMore) {
  DeadBallWatch watch;
  watch.reset({0.225, 0.0, 0.0173});
  int dead_at = 0;
  for (int tick = 1; tick <= 20000 && dead_at == 0; ++tick) {
    if (watch.update(table, Rules{}, {0.225, 0.0, 0.0173}, tick == 5000)) dead_at = tick;
  }
  EXPECT_NEAR(dead_at, 11000, 1);
}

}  // namespace
}  // namespace foosball
