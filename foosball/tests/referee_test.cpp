#include "../src/referee.h"

#include "bodies.h"
#include "foosball/reach.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foosball {
namespace {

const TableSpec& kTable = table_spec(Layout::tournament);
constexpr double kLine = 0.6;

TEST(Goal, CountsOnlyOnceTheBallHasWhollyPassedTheLine) {
  const double r = kTable.ball_radius;
  EXPECT_EQ(goal_by(kTable, {kLine, 0, r}), std::nullopt) << "half over the line";
  EXPECT_EQ(goal_by(kTable, {kLine + r - 1e-6, 0, r}), std::nullopt);
  EXPECT_EQ(goal_by(kTable, {kLine + r + 1e-6, 0, r}), 0);
  EXPECT_EQ(goal_by(kTable, {-kLine - r - 1e-6, 0, r}), 1) << "team 0 defends -x";
}

TEST(Goal, IsOnlyInsideTheOpening) {
  EXPECT_EQ(goal_by(kTable, {0.65, 0.11, 0.02}), std::nullopt);
  EXPECT_EQ(goal_by(kTable, {0.65, 0.0, 0.09}), std::nullopt);
  EXPECT_EQ(goal_by(kTable, {0.65, 0.10, 0.02}), 0);
}

TEST(OutOfTable, IsOverAWallOrBelowTheFieldButNotInAGoal) {
  EXPECT_FALSE(out_of_table(kTable, {0, 0, 0.5})) << "high over the field it may fall back";
  EXPECT_FALSE(out_of_table(kTable, {0.65, 0.0, 0.02}));
  EXPECT_TRUE(out_of_table(kTable, {0.0, 0.341, 0.15}));
  EXPECT_TRUE(out_of_table(kTable, {-0.61, 0.0, 0.15})) << "over the goal";
  EXPECT_TRUE(out_of_table(kTable, {0.65, 0.2, 0.02}));
  EXPECT_TRUE(out_of_table(kTable, {0.75, 0.0, 0.02})) << "behind the goal box";
  EXPECT_TRUE(out_of_table(kTable, {0, 0, -0.001}));
}

TEST(Itsf2, TheLastSetNeedsFiveGoalsAndTwoMoreThanTheOtherButNeverMoreThanEight) {
  const Rules rules = itsf_rules(1);
  const auto last = [&](int a, int b) { return winner(rules, {a, b}, true, false); };
  EXPECT_EQ(last(4, 0), std::nullopt);
  EXPECT_EQ(last(5, 3), 0);
  EXPECT_EQ(last(4, 5), std::nullopt);
  EXPECT_EQ(last(4, 6), 1);
  EXPECT_EQ(last(6, 7), std::nullopt);
  EXPECT_EQ(last(7, 7), std::nullopt);
  EXPECT_EQ(last(7, 8), 1) << "the most there is";
}

TEST(Itsf2, AnEarlierSetIsWonByTheFirstToFive) {
  const Rules rules = itsf_rules(3);
  EXPECT_EQ(winner(rules, {4, 4}, false, false), std::nullopt);
  EXPECT_EQ(winner(rules, {5, 4}, false, false), 0);
}

TEST(Winner, InArcadeIsTheFirstToFive) {
  EXPECT_EQ(winner(arcade_rules(), {4, 4}, true, false), std::nullopt);
  EXPECT_EQ(winner(arcade_rules(), {4, 5}, true, false), 1);
}

TEST(Winner, WhenTheTimeIsOverIsWhoeverLeads) {
  EXPECT_EQ(winner(arcade_rules(), {2, 1}, true, true), 0);
  EXPECT_EQ(winner(arcade_rules(), {2, 2}, true, true), std::nullopt);
}

TEST(DeadBallPlace, IsTheNearestDefenceOrTheServersMidfieldBetweenTheMidfields) {
  const auto place = [](double x, int server) {
    return kTable.rods[rod_for_dead_ball(kTable, x, server)];
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

TEST(Itsf24, TheBallHeldTooLongGoesFromTheAttackToTheDefenceElseToTheMidfieldOfTheOpponent) {
  for (int team = 0; team < kTeams; ++team) {
    for (const Line line : {Line::goalie, Line::defence, Line::midfield, Line::attack}) {
      const RodSpec& to = kTable.rods[rod_after_possession(kTable, team, line)];
      EXPECT_EQ(to.team, 1 - team);
      EXPECT_EQ(to.line, line == Line::attack ? Line::defence : Line::midfield);
    }
  }
}

struct Called {
  BallWatch::Verdict verdict = BallWatch::Verdict::alive;
  int tick = 0;
};

// The first verdict of the watch for a ball on this path, and its time.
template <class Path>
Called call(const Rules& rules, Path path, int limit, bool touched = false,
            std::array<bool, kTeams> absent = {}) {
  BallWatch watch;
  watch.reset(path(0));
  for (int tick = 1; tick <= limit; ++tick) {
    BallWatch::Sight sight{.ball = path(tick),
                           .velocity = (1.0 / kTick) * (path(tick) - path(tick - 1))};
    sight.rods_in_reach = rods_in_reach(kTable, built_in(1, 1), sight.ball);
    sight.touched = touched;
    sight.absent = absent;
    const auto verdict = watch.update(kTable, rules, sight);
    if (verdict != BallWatch::Verdict::alive) return {verdict, tick};
  }
  return {};
}
auto resting(double x, double y) {
  return [=](int) { return vp::Vec3{x, y, kTable.ball_radius}; };
}

TEST(Itsf8, ABallThatHasStoppedOutOfReachIsDeadAfterASecond) {
  const Called called = call(itsf_rules(), resting(0.0, 0.1), 20000);
  EXPECT_EQ(called.verdict, BallWatch::Verdict::dead);
  EXPECT_NEAR(called.tick, 1000, 1);
}

TEST(Itsf8, ABallThatMovesOutOfReachIsDeadAfterTheTimeOfTheRules) {
  const auto rolling = [](int tick) { return vp::Vec3{0.0, 0.02 * std::sin(0.01 * tick), 0.0173}; };
  const Called called = call(itsf_rules(), rolling, 20000);
  EXPECT_EQ(called.verdict, BallWatch::Verdict::dead);
  EXPECT_NEAR(called.tick, 1e3 * itsf_rules().dead_ball_seconds, 1);
}

TEST(Itsf24, AHeldBallHasTenSecondsOnTheMidfieldAndFifteenElsewhere) {
  for (const bool touched : {false, true}) {
    const Called midfield = call(itsf_rules(), resting(-0.075, 0.0), 20000, touched);
    EXPECT_EQ(midfield.verdict, BallWatch::Verdict::held);
    EXPECT_NEAR(midfield.tick, 10000, 1);
    const Called defence = call(itsf_rules(), resting(-0.375, 0.0), 20000, touched);
    EXPECT_EQ(defence.verdict, BallWatch::Verdict::held);
    EXPECT_NEAR(defence.tick, 15000, 1);
  }
}

TEST(Itsf24, DribblingDoesNotStopTheClock) {
  const auto dribble = [](int tick) {
    return vp::Vec3{0.225, 0.2 * std::sin(0.004 * tick), kTable.ball_radius};
  };
  EXPECT_NEAR(call(itsf_rules(), dribble, 20000, true).tick, 15000, 1);
}

TEST(Itsf24, GoalieAndDefenceAreOnePlaceOfPossession) {
  // Back and forth between the two rods, out of reach of both in between.
  const auto pass = [](int tick) {
    return vp::Vec3{-0.45 + 0.06 * std::sin(0.004 * tick), 0.0, kTable.ball_radius};
  };
  const Called called = call(itsf_rules(), pass, 40000, true);
  EXPECT_EQ(called.verdict, BallWatch::Verdict::held);
  EXPECT_LT(called.tick, 25000);
}

TEST(Itsf24, ABallThatHasLeftTheRodIsANewPossession) {
  const auto leaves = [](int tick) {
    const bool away = tick % 9000 > 8500;
    return vp::Vec3{away ? -0.15 : -0.075, 0.0, kTable.ball_radius};
  };
  EXPECT_EQ(call(itsf_rules(), leaves, 40000, true).verdict, BallWatch::Verdict::alive);
}

TEST(ArcadeStillBall, IsTakenAfterFiveSecondsUntouchedWithinReach) {
  const Called called = call(arcade_rules(), resting(-0.375, 0.0), 20000);
  EXPECT_EQ(called.verdict, BallWatch::Verdict::held);
  EXPECT_NEAR(called.tick, 5000, 1);
}

TEST(ArcadeStillBall, OfAnAbsentSideIsTakenAfterHalfASecond) {
  const auto at_defence_of_0 = resting(-0.375, 0.0);
  const Called absent = call(arcade_rules(), at_defence_of_0, 20000, false, {true, false});
  EXPECT_EQ(absent.verdict, BallWatch::Verdict::held);
  EXPECT_NEAR(absent.tick, 500, 1);
  EXPECT_NEAR(call(arcade_rules(), at_defence_of_0, 20000, false, {false, true}).tick, 5000, 1);
  EXPECT_NEAR(call(itsf_rules(), at_defence_of_0, 20000, false, {true, false}).tick, 15000, 1)
      << "the ITSF's rules do not judge a ball that lies still";
}

}  // namespace
}  // namespace foosball
