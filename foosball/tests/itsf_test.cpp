// Each ITSF rule that the match judges, named after the article of the rule book (2016).
// referee_test.cpp and spin_watch_test.cpp test the underlying counts.
#include "match_fixture.h"

namespace foosball {
namespace {

Rules quick(Rules rules) {
  rules.ceremony_seconds = 0.7;
  rules.end_seconds = 0.8;
  rules.time_out_seconds = 2.0;
  return rules;
}

class ItsfTest : public MatchTest {
 protected:
  explicit ItsfTest(const Rules& rules = quick(itsf_rules(3)))
      : MatchTest(Layout::tournament, rules) {
    start_by_commands();
    run(0.6);
  }
  // The ball rests in front of a hanging man of the rod.
  void give_ball(int team, Line line) {
    const int rod = rods_of_team(table(), team)[static_cast<int>(line)];
    shoot({table().rods[rod].x + 0.034 * attack_sign(team), 0.0, 0.0173}, {}, team);
    run(0.02);
  }
  // The latest event of this kind; an invalid one if there was none.
  Event latest(EventKind kind) const {
    const Event* event = last(kind);
    EXPECT_NE(event, nullptr) << static_cast<int>(kind);
    return event != nullptr ? *event : Event{kind, 9, 0, 0, 99.0, {}};
  }
  int server_of_last() const { return latest(EventKind::serve).team; }
  Line line_of_last() const { return table().rods[latest(EventKind::serve).rod].line; }
  Foul last_foul() const { return static_cast<Foul>(std::lround(latest(EventKind::foul).value)); }
  // Team 0's attack rotates forward. After more than a revolution the ball is put in front of its
  // foot.
  void spin_at_ball() {
    const int rod = rods_of_team(table(), 0)[3];
    shoot({-0.45, 0.0, 0.0173}, {});
    for (int i = 0; i < 700; ++i) {
      input.rods[rod].angle = -0.02 * i;
      step();
      if (i == 500) shoot({table().rods[rod].x + 0.034, 0.0, 0.0173}, {}, 0);
      if (i > 500 && count(EventKind::foul) > 0) break;
    }
  }
  void score(int team) {
    shoot_goal(team);
    run(kQuick.ceremony_seconds + 0.7);
  }
};

TEST_F(ItsfTest, Article2TheMatchGoesToTheSideThatWinsMostSets) {
  for (int goal = 0; goal < 5; ++goal) score(0);
  EXPECT_EQ(view().sets, (std::array<int, 2>{1, 0}));
  EXPECT_EQ(view().score, (std::array<int, 2>{0, 0}));
  EXPECT_EQ(count(EventKind::set_won), 1);
  EXPECT_EQ(count(EventKind::match_won), 0);
  for (int goal = 0; goal < 5; ++goal) score(1);
  EXPECT_EQ(view().sets, (std::array<int, 2>{1, 1}));
  for (int goal = 0; goal < 4; ++goal) score(0);
  for (int goal = 0; goal < 4; ++goal) score(1);
  score(0);
  EXPECT_EQ(count(EventKind::match_won), 0) << "5:4 in the last set";
  score(0);
  EXPECT_EQ(count(EventKind::match_won), 1);
  EXPECT_EQ(latest(EventKind::match_won).team, 0);
}

TEST_F(ItsfTest, Article4TheServeIsFromTheMiddleManOfTheMidfield) {
  const Event* serve = last(EventKind::serve);
  ASSERT_NE(serve, nullptr);
  EXPECT_EQ(table().rods[serve->rod].line, Line::midfield);
  EXPECT_EQ(serve->man, 2);
}

TEST_F(ItsfTest, Article4_2_2AServeThatNoSecondManTouchedScoresNothingAndTheOpponentServes) {
  const int server = server_of_last();
  arrange([&](MatchState& state, TableWorld& world) {
    state.touched = 0b1;
    world.set_ball({attack_sign(server) * 0.56, 0.08, 0.0174}, {attack_sign(server) * 5.0, 0, 0});
  });
  run(0.1);
  EXPECT_EQ(view().score, (std::array<int, 2>{0, 0}));
  EXPECT_EQ(last_foul(), Foul::serve);
  EXPECT_EQ(view().last_foul_team, server);
  run(0.6);
  EXPECT_EQ(server_of_last(), 1 - server);
  EXPECT_EQ(line_of_last(), Line::midfield);
}

TEST_F(ItsfTest, Article5TheSideThatConcededServesAndInANewSetTheOneThatLostTheLast) {
  score(0);
  EXPECT_EQ(server_of_last(), 1);
  score(1);
  EXPECT_EQ(server_of_last(), 0);
  for (int goal = 0; goal < 4; ++goal) score(1);
  ASSERT_EQ(view().sets[1], 1);
  EXPECT_EQ(server_of_last(), 0);
}

TEST_F(ItsfTest, Article7_3ABallOffTheTableGoesToTheOpponentsDefence) {
  for (int team = 0; team < kTeams; ++team) {
    shoot({0.0, 0.2, 0.2}, {0.0, 6.0, 1.0}, team);
    run(0.8);
    EXPECT_EQ(server_of_last(), 1 - team);
    EXPECT_EQ(line_of_last(), Line::defence);
  }
  EXPECT_EQ(count(EventKind::ball_out), 2);
}

TEST_F(ItsfTest, Article8ADeadBallGoesToTheNearestDefenceOrIsServedAgain) {
  for (RodTarget& rod : input.rods) rod.angle = 1.5;
  run(0.3);
  int server = 0;
  shoot({0.40, 0.33 - 0.0173, 0.5}, {});  // into the corner that the two men do not reach
  arrange([](MatchState&, TableWorld& world) { world.set_ball({0.45, 0.0, 0.0173}, {}); });
  for (int i = 0; i < 2500; ++i) {
    arrange([](MatchState&, TableWorld& world) { world.set_ball({0.448, 0.0, 0.0173}, {}); });
    step();
    if (count(EventKind::dead_ball) > 0) break;
  }
  ASSERT_EQ(count(EventKind::dead_ball), 1);
  run(0.6);
  EXPECT_EQ(server_of_last(), 1);
  EXPECT_EQ(line_of_last(), Line::defence);
  events.clear();
  arrange([&](MatchState& state, TableWorld&) { server = state.last_server; });
  for (int i = 0; i < 2500 && count(EventKind::dead_ball) == 0; ++i) {
    arrange([](MatchState&, TableWorld& world) { world.set_ball({0.0, 0.0, 0.0173}, {}); });
    step();
  }
  run(0.6);
  EXPECT_EQ(server_of_last(), server);
  EXPECT_EQ(line_of_last(), Line::midfield);
}

TEST_F(ItsfTest, Article9EachSideHasTwoTimeOutsInASetWhileItHasTheBall) {
  for (int taken = 1; taken <= 2; ++taken) {
    give_ball(0, Line::attack);
    command(Command::Kind::time_out, 0);
    EXPECT_EQ(count(EventKind::time_out), taken);
    EXPECT_EQ(view().time_outs_left[0], 2 - taken);
    EXPECT_GT(view().time_out_seconds, 0.0);
    const double clock = view().play_seconds;
    run(1.9);
    EXPECT_EQ(view().play_seconds, clock) << "time stands still";
    EXPECT_FALSE(view().ball_in_play);
    run(0.7);
    ASSERT_TRUE(view().ball_in_play);
    EXPECT_EQ(line_of_last(), Line::attack) << "10: at the rod that had the ball";
    EXPECT_EQ(server_of_last(), 0);
  }
  for (int goal = 0; goal < 5; ++goal) score(1);
  EXPECT_EQ(view().time_outs_left[0], 2) << "a new set";
}

TEST_F(ItsfTest, Article9_1ATimeOutEndsEarlyWhenBothSidesPush) {
  give_ball(0, Line::attack);
  command(Command::Kind::time_out, 0);
  command(Command::Kind::push, 1);
  run(0.2);
  EXPECT_GT(view().time_out_seconds, 0.0) << "either may take the whole of it";
  push(0);
  EXPECT_EQ(view().time_out_seconds, 0.0);
}

TEST_F(ItsfTest, Article9_6_1WithoutTheBallNoTimeOut) {
  give_ball(1, Line::attack);
  command(Command::Kind::time_out, 0);
  EXPECT_EQ(count(EventKind::time_out), 0);
  EXPECT_EQ(last_foul(), Foul::time_out);
  EXPECT_TRUE(view().ball_in_play);
  EXPECT_EQ(view().time_outs_left[0], 2);
}

TEST_F(ItsfTest, Article9BetweenBallsEitherSideMay) {
  shoot_goal(0);
  run(kQuick.ceremony_seconds);
  ASSERT_FALSE(view().ball_in_play);
  command(Command::Kind::time_out, 0);
  EXPECT_EQ(count(EventKind::time_out), 1);
  run(2.7);
  EXPECT_EQ(server_of_last(), 1) << "10.2: by whoever was to serve";
}

TEST_F(ItsfTest, Article9_8AThirdTimeOutLosesTheBall) {
  arrange([](MatchState& state, TableWorld&) { state.tally.time_outs = {2, 2}; });
  give_ball(0, Line::attack);
  command(Command::Kind::time_out, 0);
  EXPECT_EQ(count(EventKind::time_out), 0);
  run(0.7);
  EXPECT_EQ(server_of_last(), 1);
  EXPECT_EQ(line_of_last(), Line::midfield);
}

TEST_F(ItsfTest, Article12InAndOutCounts) {
  shoot({0.58, 0.07, 0.0174}, {15.0, 0.0, 0.0});
  run(0.3);
  EXPECT_EQ(view().score[0], 1);
  EXPECT_EQ(count(EventKind::goal), 1) << "once";
}

TEST_F(ItsfTest, Article15_1ASpinThatStrikesTheBallGivesItToTheOpponent) {
  spin_at_ball();
  EXPECT_EQ(last_foul(), Foul::spin);
  EXPECT_EQ(view().last_foul_team, 0);
  EXPECT_EQ(view().score, (std::array<int, 2>{0, 0}));
  run(0.7);
  EXPECT_EQ(server_of_last(), 1);
  EXPECT_EQ(line_of_last(), Line::midfield);
}

TEST_F(ItsfTest, Article15_2ASpinAwayFromTheBallIsNone) {
  give_ball(0, Line::attack);
  move(0, 0.0, 3.0 * vp::kPi, 0.3);
  EXPECT_EQ(count(EventKind::foul), 0);
}

TEST_F(ItsfTest, Article15_2ASpinIntoTheOwnGoalCounts) {
  const int goalie = rods_of_team(table(), 0)[0];
  shoot({-0.625, 0.05, 0.0174}, {}, 0);
  arrange([&](MatchState& state, TableWorld&) {
    state.touch.rod = state.touch_of[0].rod = goalie;
    state.touch.man = state.touch_of[0].man = 0;
    state.spins[goalie].reset(0.0);
    for (int i = 0; i <= 70; ++i) state.spins[goalie].update(0.1 * i, i == 70);
    ASSERT_TRUE(state.spins[goalie].spun());
  });
  run(0.1);
  EXPECT_EQ(view().score[1], 1);
  EXPECT_TRUE(view().last_goal_own);
}

TEST_F(ItsfTest, Article16SlammingARodWhileTheOpponentHasTheBallIsJarring) {
  const int rod = rods_of_team(table(), 1)[2];
  const double limit = table().rods[rod].slide_limit;
  for (int slam = 1; slam <= 3; ++slam) {
    input.rods[rod] = {0.0, 0.0, 0.0, 0.0, true};
    run(0.3);
    give_ball(0, Line::attack);
    run(1.0);
    const double before = view().possession_seconds;
    move(rod, 2.0 * limit, 0.0, 0.03);
    ASSERT_EQ(count(EventKind::foul), slam);
    EXPECT_EQ(view().last_foul_team, 1);
    if (slam < 3) {
      EXPECT_EQ(last_foul(), Foul::jarring);
      EXPECT_LT(view().possession_seconds, before) << "17: reset";
    }
  }
  EXPECT_EQ(last_foul(), Foul::technical) << "16.4";
  run(0.6);
  EXPECT_EQ(server_of_last(), 0);
  EXPECT_EQ(line_of_last(), Line::attack) << "27";
}

TEST_F(ItsfTest, Article24_3TheBallHeldTooLongOnTheAttackGoesToTheOpponentsDefence) {
  give_ball(0, Line::attack);
  run(15.7);
  EXPECT_EQ(last_foul(), Foul::possession);
  EXPECT_EQ(server_of_last(), 1);
  EXPECT_EQ(line_of_last(), Line::defence);
}

TEST_F(ItsfTest, Article24_3TheBallHeldTooLongElsewhereGoesToTheOpponentsMidfield) {
  give_ball(0, Line::defence);
  run(15.7);
  EXPECT_EQ(last_foul(), Foul::possession);
  EXPECT_EQ(server_of_last(), 1);
  EXPECT_EQ(line_of_last(), Line::midfield);
}

class ChangeOfSides : public ItsfTest {
 protected:
  ChangeOfSides()
      : ItsfTest([] {
          Rules rules = quick(itsf_rules(3));
          rules.change_sides = true;
          return rules;
        }()) {}
};

TEST_F(ChangeOfSides, Article13SetsAndCharactersGoRoundTheTableWithTheirPlayers) {
  arrange([](MatchState& state, TableWorld&) { state.character = {1, 1}; });
  for (int goal = 0; goal < 5; ++goal) score(0);
  EXPECT_EQ(view().sets, (std::array<int, 2>{0, 1}));
  EXPECT_EQ(server_of_last(), 0) << "5: who lost the set now stands there";
}

// --- the arcade rules, where they differ ---------------------------------------------------------

class ArcadeTest : public ItsfTest {
 protected:
  ArcadeTest() : ItsfTest(quick(arcade_rules())) {}
};

TEST_F(ArcadeTest, IsWonByTheFirstToFive) {
  arrange([](MatchState& state, TableWorld&) { state.tally.score = {4, 4}; });
  shoot_goal(1);
  EXPECT_EQ(count(EventKind::match_won), 1);
}

TEST_F(ArcadeTest, ASpinPlaysOnButItsGoalIsVoid) {
  const int rod = rods_of_team(table(), 0)[3];
  shoot({0.58, 0.07, 0.0174}, {5.0, 0.0, 0.0}, 0);
  arrange([&](MatchState& state, TableWorld&) {
    state.spins[rod].reset(0.0);
    for (int i = 0; i <= 70; ++i) state.spins[rod].update(0.1 * i, i == 70);
    ASSERT_TRUE(state.spins[rod].spun());
  });
  for (RodTarget& target : input.rods) target.live = false;
  run(0.05);
  EXPECT_EQ(view().score, (std::array<int, 2>{0, 0}));
  EXPECT_EQ(last_foul(), Foul::spin);
  run(0.7);
  EXPECT_EQ(server_of_last(), 1);
  EXPECT_EQ(line_of_last(), Line::defence);
}

TEST_F(ArcadeTest, AGoalWaitsForTheRodThatShotToStop) {
  const int rod = rods_of_team(table(), 0)[3];
  shoot({0.60, 0.07, 0.0174}, {5.0, 0.0, 0.0}, 0);
  arrange([&](MatchState& state, TableWorld&) {
    state.spins[rod].reset(0.0);
    state.spins[rod].update(0.0, true);
  });
  input.rods[rod] = {0.0, 0.0, 0.0, 0.0, true};
  run(0.03);
  EXPECT_EQ(count(EventKind::goal), 0) << "it may still go round";
  EXPECT_TRUE(view().ball_visible);
  run(0.1);
  EXPECT_EQ(count(EventKind::goal), 1);
}

class TimedTest : public ItsfTest {
 protected:
  explicit TimedTest(int sets_to_win = 1)
      : ItsfTest([sets_to_win] {
          Rules rules = quick(arcade_rules());
          rules.match_seconds = 5.0;
          rules.goals_to_win = rules.max_goals = 99;
          rules.sets_to_win = sets_to_win;
          return rules;
        }()) {}
};

class TimedSetsTest : public TimedTest {
 protected:
  TimedSetsTest() : TimedTest(2) {}
};

// The ceremony distinguishes a ball in the goal from none.
TEST_F(TimedSetsTest, ASetThatEndsOnTheClockIsWonWithoutAGoalAndNoBallLiesInOne) {
  arrange([](MatchState& state, TableWorld&) { state.tally.score = {1, 2}; });
  events.clear();
  run(5.0);
  EXPECT_EQ(view().screen, Screen::ceremony);
  EXPECT_FALSE(view().ball_visible);
  EXPECT_EQ(count(EventKind::goal), 0);
  EXPECT_EQ(latest(EventKind::set_won).team, 1);
  EXPECT_EQ(view().last_scorer, 1);
  EXPECT_EQ(view().sets, (std::array<int, 2>{0, 1}));
  EXPECT_EQ(view().score, (std::array<int, 2>{1, 2})) << "is still to be read";
  run(desc.rules.ceremony_seconds);
  EXPECT_EQ(view().screen, Screen::play);
  EXPECT_EQ(view().next_server, 0) << "who lost the set serves (5)";
}

TEST_F(TimedSetsTest, AGoldenGoalEndsTheSetWithTheBallInTheGoal) {
  run(5.5);
  ASSERT_TRUE(view().golden_goal);
  shoot_goal(1);
  EXPECT_EQ(view().screen, Screen::ceremony);
  EXPECT_TRUE(view().ball_visible);
  EXPECT_EQ(latest(EventKind::goal).team, 1);
  EXPECT_EQ(latest(EventKind::set_won).team, 1);
}

TEST_F(TimedTest, WhoLeadsWhenTheTimeIsOverHasWon) {
  EXPECT_TRUE(view().timed);
  arrange([](MatchState& state, TableWorld&) { state.tally.score = {1, 2}; });
  run(5.0);
  EXPECT_EQ(latest(EventKind::match_won).team, 1);
  EXPECT_EQ(view().screen, Screen::end);
}

TEST_F(TimedTest, AfterADrawTheNextGoalDecides) {
  run(5.5);
  EXPECT_TRUE(view().golden_goal);
  EXPECT_EQ(view().screen, Screen::play);
  shoot_goal(1);
  EXPECT_EQ(latest(EventKind::match_won).team, 1);
}

}  // namespace
}  // namespace foosball
