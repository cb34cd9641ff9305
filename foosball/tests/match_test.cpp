// The match as a step function: every transition of its screens, by rods alone and by commands;
// serve, goals, dead ball, ball out, win.
#include <limits>

#include "bodies.h"
#include "match_fixture.h"

namespace foosball {
namespace {

// --- screens by rods alone -----------------------------------------------------------------------

TEST_F(MatchTest, APushOfAnyRodLeavesTheLogo) {
  for (int rod = 0; rod < kRods; ++rod) {
    match = std::make_unique<Match>(*Match::create(desc));
    input.rods[rod] = {0, 0, 0, 0, true};
    ASSERT_EQ(view().screen, Screen::logo);
    push(rod);
    EXPECT_EQ(view().screen, Screen::selection) << rod;
    EXPECT_FALSE(view().confirmed[0] || view().confirmed[1]) << "one push is one request";
  }
}

TEST_F(MatchTest, SpinningAnyRodOfATeamChoosesItsCharacterAndOnlyItsOwn) {
  command(Command::Kind::push);
  const double third = 2.0 * vp::kPi / 3.0 + 0.05;
  for (int rod = 0; rod < kRods; ++rod) {
    const int team = table().rods[rod].team;
    const auto before = view().character;
    const double forward = -attack_sign(team);
    move(rod, 0.0, forward * third, 0.3);
    EXPECT_EQ(view().character[team], (before[team] + 1) % built_in_count()) << rod;
    EXPECT_EQ(view().character[1 - team], before[1 - team]) << rod;
    move(rod, 0.0, 0.0, 0.3);
    EXPECT_EQ(view().character[team], before[team]) << "and back";
  }
}

TEST_F(MatchTest, BothTeamsPushToConfirmAndPlayBegins) {
  push(0);
  push(3);
  EXPECT_TRUE(view().confirmed[0]);
  EXPECT_EQ(view().screen, Screen::selection) << "the other team still chooses";
  const int chosen = view().character[0];
  move(3, 0.0, 3.0, 0.3);
  EXPECT_EQ(view().character[0], chosen) << "confirmed is confirmed";
  push(7);
  EXPECT_EQ(view().screen, Screen::play);
}

TEST_F(MatchTest, TheMenTakeOnTheChosenCharacterAndTheRodsStayInTheHands) {
  command(Command::Kind::push);
  move(5, -0.05, 1.0, 0.3);
  command(Command::Kind::choose_character, 0, 2);
  command(Command::Kind::push, 0);
  command(Command::Kind::push, 1);
  EXPECT_EQ(view().character[0], 2);
  EXPECT_NEAR(view().rods[5].slide, -0.05, 1e-4);
  EXPECT_NEAR(view().rods[5].angle, 1.0, 1e-3);
  arrange([](MatchState& state, TableWorld&) {
    EXPECT_EQ(state.built[0], 2);
    EXPECT_EQ(state.built[1], 1);
  });
}

TEST_F(MatchTest, RodsNeverWaitForAMenu) {
  const Screen screens[] = {Screen::logo, Screen::selection, Screen::play, Screen::ceremony,
                            Screen::end};
  for (const Screen screen : screens) {
    arrange([&](MatchState& state, TableWorld&) {
      state.screen = screen;
      state.screen_ticks = 0;
      state.ball_in_play = false;
      state.ball_parked = true;
    });
    move(1, -0.04, 0.5 * vp::kPi, 0.2);
    EXPECT_NEAR(view().rods[1].slide, -0.04, 0.0005) << static_cast<int>(screen);
    EXPECT_NEAR(view().rods[1].angle, 0.5 * vp::kPi, vp::kPi / 180.0);
    move(1, 0.0, 0.0, 0.2);
  }
}

TEST_F(MatchTest, APushShortensTheCeremonyAndTheEnd) {
  start_by_commands();
  shoot_goal(0);
  ASSERT_EQ(view().screen, Screen::ceremony);
  run(0.5);
  push(0);
  EXPECT_EQ(view().screen, Screen::play);
  arrange([](MatchState& state, TableWorld&) { state.tally.score = {4, 0}; });
  shoot_goal(0);
  ASSERT_EQ(view().screen, Screen::end);
  run(0.5);
  push(7);
  EXPECT_EQ(view().screen, Screen::logo);
}

// --- screens by commands and by time -------------------------------------------------------------

TEST_F(MatchTest, CommandsWorkTheScreensAsRodsDo) {
  command(Command::Kind::push, 1);
  EXPECT_EQ(view().screen, Screen::selection);
  command(Command::Kind::choose_character, 1, 0);
  EXPECT_EQ(view().character[1], 0);
  command(Command::Kind::push, 1);
  EXPECT_TRUE(view().confirmed[1]);
  EXPECT_FALSE(view().confirmed[0]);
  command(Command::Kind::push, 0);
  EXPECT_EQ(view().screen, Screen::play);
  command(Command::Kind::restart);
  EXPECT_EQ(view().screen, Screen::logo);
  EXPECT_EQ(count(EventKind::screen), 3);
}

TEST_F(MatchTest, ATuningCommandTakesEffectInItsTickAndOneOutOfRangeDoesNot) {
  const auto tune = [&](int index, double amount) {
    commands.push_back({Command::Kind::tune, 0, static_cast<std::uint8_t>(index), amount});
    step();
  };
  const int gravity = tuning_index("gravity");
  ASSERT_GE(gravity, 0);
  tune(gravity, 9.0);
  EXPECT_EQ(view().tuning.gravity, 9.0);
  tune(gravity, 1000.0);
  tune(gravity, std::nan(""));
  tune(kTuningValues, 1.0);
  EXPECT_EQ(view().tuning.gravity, 9.0);
  Tuning expected;
  expected.gravity = 9.0;
  EXPECT_TRUE(view().tuning == expected);
}

TEST_F(MatchTest, RequestsOutOfRangeAreIgnored) {
  command(Command::Kind::push, 2);
  EXPECT_EQ(view().screen, Screen::logo);
  command(Command::Kind::push, 0);
  command(Command::Kind::choose_character, 0, built_in_count());
  command(Command::Kind::choose_character, 255, 0);
  commands.push_back({static_cast<Command::Kind>(200), 0, 0});
  step();
  EXPECT_EQ(view().character[0], 1);
  EXPECT_EQ(view().screen, Screen::selection);
}

TEST_F(MatchTest, PauseStopsTimeAndOnlyDuringPlay) {
  command(Command::Kind::pause, 0, 1);
  EXPECT_FALSE(view().paused) << "nothing to pause at the logo";
  start_by_commands();
  run(0.6);
  command(Command::Kind::pause, 0, 1);
  ASSERT_TRUE(view().paused);
  const MatchView before = view();
  run(0.5);
  EXPECT_EQ(view().play_seconds, before.play_seconds);
  EXPECT_EQ(view().ball_position, before.ball_position);
  command(Command::Kind::pause, 0, 0);
  EXPECT_FALSE(view().paused);
  EXPECT_GT(view().play_seconds, before.play_seconds);
}

TEST_F(MatchTest, CeremonyAndEndPassByThemselves) {
  start_by_commands();
  arrange([](MatchState& state, TableWorld&) { state.tally.score = {3, 3}; });
  shoot_goal(1);
  ASSERT_EQ(view().screen, Screen::ceremony);
  run(kQuick.ceremony_seconds);
  EXPECT_EQ(view().screen, Screen::play);
  shoot_goal(1);
  ASSERT_EQ(view().screen, Screen::end);
  EXPECT_EQ(count(EventKind::match_won), 1);
  run(kQuick.end_seconds);
  EXPECT_EQ(view().screen, Screen::logo);
  EXPECT_EQ(view().score, (std::array<int, 2>{0, 0}));
}

// --- play ----------------------------------------------------------------------------------------

TEST_F(MatchTest, TheBallIsServedToTheMidfieldWithinItsReach) {
  start_by_commands();
  EXPECT_FALSE(view().ball_in_play);
  run(0.6);
  ASSERT_TRUE(view().ball_in_play);
  ASSERT_EQ(count(EventKind::serve), 1);
  const int server = std::find_if(events.begin(), events.end(), [](const Event& event) {
                       return event.kind == EventKind::serve;
                     })->team;
  const RodSpec& rod = table().rods[rods_of_team(table(), server)[2]];
  EXPECT_NEAR(view().ball_position.x, rod.x + attack_sign(server) * Tuning{}.serve_ahead, 0.005);
}

TEST_F(MatchTest, TheServeWaitsWhileMenFillThePlace) {
  start_by_commands();
  // The server's men hang down. At every slide the ball gets a place outside the men.
  for (int i = 0; i < 40; ++i) {
    arrange([&](MatchState& state, TableWorld& world) {
      state.ball_in_play = false;
      state.ball_parked = true;
      state.serve_in = 0;
      for (int rod = 0; rod < kRods; ++rod) {
        state.hold[rod].live = true;  // the hand has just released it here:
        const double swing = 0.15 * ((i * 7 + rod * 5) % 40) - 3.0;
        world.set_rod(
            rod, {table().rods[rod].slide_limit * 0.05 * ((i * 3 + rod) % 40 - 20), swing, 0, 0});
      }
    });
    for (int rod = 0; rod < kRods; ++rod) input.rods[rod].live = false;
    run(0.05);
    if (!view().ball_in_play) continue;
    EXPECT_LT(vp::norm(view().ball_velocity), 0.3) << "nothing throws it off its place";
  }
}

TEST_F(MatchTest, AGoalAtEachEndCountsForTheTeamThatAttacksIt) {
  start_by_commands();
  for (int scorer = 0; scorer < kTeams; ++scorer) {
    arrange([](MatchState& state, TableWorld&) {
      state.screen = Screen::play;
      state.tally.score = {};
    });
    shoot_goal(scorer);
    EXPECT_EQ(view().score[scorer], 1);
    EXPECT_EQ(view().score[1 - scorer], 0);
    EXPECT_EQ(view().last_scorer, scorer);
    EXPECT_EQ(view().screen, Screen::ceremony);
    EXPECT_FALSE(view().ball_in_play);
  }
  EXPECT_EQ(count(EventKind::goal), 2);
}

TEST_F(MatchTest, AnOwnGoalCountsForTheOther) {
  start_by_commands();
  shoot({-0.56, 0.08, 0.0174}, {-5.0, 0.0, 0.0}, /*toucher=*/0);
  run(0.1);
  EXPECT_EQ(view().score[1], 1);
}

TEST_F(MatchTest, InAndOutCounts) {
  start_by_commands();
  // At 15 m/s the ball enters, bounces off the back of the box and leaves within a few ticks.
  shoot({0.58, 0.07, 0.0174}, {15.0, 0.0, 0.0});
  run(0.3);
  EXPECT_EQ(view().score[0], 1);
  EXPECT_EQ(count(EventKind::goal), 1) << "once";
}

TEST_F(MatchTest, AShotStraightFromTheServeIsNoGoal) {
  start_by_commands();
  run(0.6);
  arrange([](MatchState& state, TableWorld& world) {
    ASSERT_TRUE(state.served);
    state.touched = 0b1;
    world.set_ball({0.56, 0.08, 0.0174}, {5.0, 0.0, 0.0});
  });
  run(0.1);
  EXPECT_EQ(view().score, (std::array<int, 2>{0, 0}));
  EXPECT_EQ(count(EventKind::foul), 1);
  run(0.6);
  EXPECT_TRUE(view().ball_in_play) << "served again";
}

TEST_F(MatchTest, TheSideThatConcededServes) {
  for (int scorer = 0; scorer < kTeams; ++scorer) {
    command(Command::Kind::restart);
    start_by_commands();
    shoot_goal(scorer);
    events.clear();
    run(kQuick.ceremony_seconds + 0.6);
    ASSERT_EQ(count(EventKind::serve), 1);
    EXPECT_EQ(view().ball_position.x > 0.0, scorer == 0);
  }
}

TEST_F(MatchTest, AContactWhoseEndIsNeverSeenDoesNotOutliveTheNextServe) {
  start_by_commands();
  for (RodTarget& rod : input.rods) rod.angle = 1.4;
  run(0.6);
  shoot({0.30, 0.0, 0.0173}, {});
  arrange([](MatchState& state, TableWorld&) { state.touching.set(2, 1, 0, true); });
  const auto touching = [&] {
    bool any = false;
    arrange([&](MatchState& state, TableWorld&) { any = state.touching.any(); });
    return any;
  };
  EXPECT_TRUE(touching());
  events.clear();
  shoot({0.0, 1.0, 0.5}, {});  // off the table: a new serve
  run(1.0);
  EXPECT_EQ(count(EventKind::serve), 1);
  EXPECT_FALSE(touching());
}

TEST_F(MatchTest, EventsBeyondTheBoundOfAStepAreCounted) {
  constexpr std::size_t kRequests = kMaxEventsPerStep + 72;
  commands.assign(kRequests, {Command::Kind::restart});  // one screen event each
  step();
  EXPECT_EQ(events.size(), kMaxEventsPerStep);
  EXPECT_EQ(view().events_dropped, 72u);
  step();
  EXPECT_EQ(view().events_dropped, 72u);
}

TEST_F(MatchTest, ABallOffTheTableGoesToTheOpponentsDefence) {
  start_by_commands();
  shoot({0.0, 0.2, 0.2}, {0.0, 6.0, 1.0}, /*toucher=*/0);
  run(0.7);
  EXPECT_EQ(count(EventKind::ball_out), 1);
  ASSERT_TRUE(view().ball_in_play);
  EXPECT_NEAR(view().ball_position.x, 0.375 - 0.034, 0.01) << "team 1's two-man rod";
}

// --- rods ----------------------------------------------------------------------------------------

TEST_F(MatchTest, ARodThatIsNotLiveIsHeldWhereItWas) {
  move(2, 0.05, 0.8, 0.2);
  input.rods[2] = {-0.1, 99.0, 5.0, 5.0, false};
  run(0.5);
  EXPECT_NEAR(view().rods[2].slide, 0.05, 0.0005);
  EXPECT_NEAR(view().rods[2].angle, 0.8, 0.01);
}

TEST_F(MatchTest, ATargetThatIsNoNumberCountsAsNotLive) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  move(4, -0.03, -0.5, 0.2);
  const RodTarget good = input.rods[4];
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int field = 0; field < 4; ++field) {
      input.rods[4] = good;
      input.rods[4].slide = field == 0 ? bad : good.slide;
      input.rods[4].angle = field == 1 ? bad : good.angle;
      input.rods[4].slide_rate = field == 2 ? bad : 0.0;
      input.rods[4].angle_rate = field == 3 ? bad : 0.0;
      run(0.02);
      EXPECT_NEAR(view().rods[4].slide, -0.03, 0.001);
      EXPECT_NEAR(view().rods[4].angle, -0.5, 0.02);
    }
  }
}

TEST_F(MatchTest, AbsurdButFiniteTargetsMoveARodNoFurtherAndNoFasterThanAHandCould) {
  input.rods[6] = {1e300, 1e6, -1e300, 1e300, true};
  run(0.5);
  EXPECT_LE(std::fabs(view().rods[6].slide), table().rods[6].slide_limit + 1e-4);
  EXPECT_LT(std::fabs(view().rods[6].angle_rate), 151.0);
  input.rods[6].angle = -1e300;
  run(0.1);
  EXPECT_TRUE(std::isfinite(view().rods[6].angle));
}

TEST(MatchCreate, RefusesRulesThatCannotBePlayed) {
  const auto refused = [](const std::function<void(MatchDesc&)>& change) {
    MatchDesc desc;
    change(desc);
    const auto match = Match::create(desc);
    return !match && match.error().code == vp::Errc::invalid_argument;
  };
  EXPECT_TRUE(refused([](MatchDesc& d) { d.rules.goals_to_win = 0; }));
  EXPECT_TRUE(refused([](MatchDesc& d) { d.rules.max_goals = 4; }));
  EXPECT_TRUE(refused([](MatchDesc& d) { d.rules.max_goals = 1000; }));
  EXPECT_TRUE(refused([](MatchDesc& d) { d.rules.ceremony_seconds = -1.0; }));
  EXPECT_TRUE(refused([](MatchDesc& d) { d.rules.end_seconds = std::nan(""); }));
  EXPECT_TRUE(refused([](MatchDesc& d) { d.layout = static_cast<Layout>(9); }));
  EXPECT_FALSE(refused([](MatchDesc&) {}));
}

}  // namespace
}  // namespace foosball
