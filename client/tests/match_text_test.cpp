// The texts for the rules' decisions, from snapshots and stories, without a window.
#include "render/match_text.h"

#include <gtest/gtest.h>

#include "render/translate.h"
#include "scripted_scene.h"
#include "wire/enums.h"

namespace client {
namespace {

constexpr int kFirstMidfield = 3, kFirstAttack = 5, kSecondMidfield = 4;  // rods

struct Shown {
  wire::Snapshot state = scripted_play(0.35);
  HudState hud;
  Shown() { hud.state = &state; }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;
  void stop(wire::Screen screen, bool ball_in_goal) {
    state.screen = number(screen);
    state.ball_in_play = false;
    state.ball_visible = ball_in_goal;
  }
};

// The ball is in front of this rod.
wire::Snapshot held_by(int rod, float seconds, wire::RuleSet rules) {
  wire::Snapshot state = scripted_play(0.35);
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  const auto& spec = table.rods[static_cast<std::size_t>(rod)];
  state.ball.position = {static_cast<float>(spec.x) + 0.02f, 0.1f, 0.0173f};
  state.rule_set = number(rules);
  state.possession_team = static_cast<std::uint8_t>(spec.team);
  state.possession_seconds = seconds;
  return state;
}

// --- the clock of possession ---------------------------------------------------------------------

TEST(MatchText, TheClockOfPossessionCountsDownTheLastFiveSeconds) {
  const auto arcade = [](int rod, float seconds) {
    return possession_clock(held_by(rod, seconds, wire::RuleSet::arcade));
  };
  EXPECT_FALSE(arcade(kFirstMidfield, 4.9f)) << "10 s on a midfield: more than 5 are left";
  ASSERT_TRUE(arcade(kFirstMidfield, 5.5f));
  EXPECT_EQ(arcade(kFirstMidfield, 5.5f)->seconds, 5);
  EXPECT_EQ(arcade(kFirstMidfield, 5.5f)->team, 0);
  EXPECT_TRUE(arcade(kFirstMidfield, 5.5f)->hurries);
  EXPECT_EQ(arcade(kSecondMidfield, 9.5f)->seconds, 1);
  EXPECT_EQ(arcade(kSecondMidfield, 9.5f)->team, 1);
  EXPECT_FALSE(arcade(kFirstAttack, 9.5f)) << "15 s elsewhere";
  EXPECT_EQ(arcade(kFirstAttack, 12.0f)->seconds, 3);
  EXPECT_EQ(arcade(0, 14.2f)->seconds, 1) << "the goalie";
}

TEST(MatchText, ByTheTournamentsRulesTheClockIsAlwaysTold) {
  const auto clock = possession_clock(held_by(kFirstAttack, 0.5f, wire::RuleSet::itsf));
  ASSERT_TRUE(clock);
  EXPECT_EQ(clock->seconds, 15);
  EXPECT_FALSE(clock->hurries);
  EXPECT_TRUE(possession_clock(held_by(kFirstAttack, 11.0f, wire::RuleSet::itsf))->hurries);
}

TEST(MatchText, NoClockRunsWhereNobodyHasTheBall) {
  const wire::Snapshot held = held_by(kFirstMidfield, 8.0f, wire::RuleSet::itsf);
  ASSERT_TRUE(possession_clock(held));
  wire::Snapshot state = held;
  state.ball_in_play = false;
  EXPECT_FALSE(possession_clock(state));
  state = held;
  state.time_out_seconds = 20.0f;
  EXPECT_FALSE(possession_clock(state));
  state = held;
  state.mode = number(wire::Mode::training);
  EXPECT_FALSE(possession_clock(state)) << "there it is served again";
  state = held;
  state.screen = number(wire::Screen::ceremony);
  EXPECT_FALSE(possession_clock(state));
  state = held;
  const auto& rods = foosball::table_spec(foosball::Layout::tournament).rods;
  // closer to the next rod
  state.ball.position[0] = static_cast<float>(rods[kFirstMidfield].x + 0.11);
  EXPECT_FALSE(possession_clock(state)) << "on its way to another rod";
}

// --- the line of the rules -----------------------------------------------------------------------

TEST(MatchText, TheServeIsToldBeforeItAndAWhileAfter) {
  Shown shown;
  shown.state.next_server = 1;
  EXPECT_EQ(rules_line(shown.hud), "");
  shown.hud.since_serve = 0.5f;
  EXPECT_EQ(rules_line(shown.hud), "Serve: ▲ VEGA");
  shown.hud.since_serve = 3.0f;
  EXPECT_EQ(rules_line(shown.hud), "");
  shown.state.ball_in_play = false;
  EXPECT_EQ(rules_line(shown.hud), "Serve: ▲ VEGA");
  shown.state.fouled = true;
  shown.state.last_foul = number(wire::Foul::possession);
  shown.hud.since_foul = 0.2f;
  EXPECT_EQ(rules_line(shown.hud), "Foul: ● ORION, held too long  -  Serve: ▲ VEGA");
}

TEST(MatchText, AGoldenGoalIsToldWhileTheNextOneDecides) {
  Shown shown;
  shown.state.golden_goal = true;
  EXPECT_EQ(rules_line(shown.hud), "golden goal: the next one decides");
  shown.state.time_out_seconds = 12.0f;
  shown.state.time_out_team = 0;
  EXPECT_EQ(rules_line(shown.hud), "Time-out: ● ORION 12 s");
}

TEST(MatchText, TrainingTellsTheShotBesideAnyFoulAndNoServe) {
  Shown shown;
  shown.state.mode = number(wire::Mode::training);
  shown.state.last_shot = {0, 5, 1, 7.25f, 0.1745f};
  shown.state.feed_rod = 1;
  shown.state.feed_man = 1;
  shown.hud.since_serve = 0.1f;
  EXPECT_EQ(rules_line(shown.hud), "Ball for: ● ORION, Defence 2  -  Last shot: 7.2 m/s, 10°");
  shown.state.fouled = true;
  shown.state.last_foul = number(wire::Foul::serve);
  shown.hud.since_foul = 0.2f;
  EXPECT_EQ(
      rules_line(shown.hud),
      "Foul: ● ORION, faulty serve  -  Ball for: ● ORION, Defence 2  -  Last shot: 7.2 m/s, 10°");
}

// --- ceremonies ----------------------------------------------------------------------------------

TEST(MatchText, AGoalNamesItsScorerAndWhoServesNext) {
  Shown shown;
  shown.stop(wire::Screen::ceremony, true);
  shown.state.last_scorer = 0;
  shown.hud.goal = {.team = 0, .scorer_rod = 5, .scorer_man = 1, .speed = 7.4f};
  const CeremonyText text = ceremony_text(shown.hud);
  EXPECT_EQ(text.call, "GOAL");
  EXPECT_EQ(text.line, "Goal for ● ORION  -  Serve: ▲ VEGA");
  EXPECT_EQ(text.detail, "● ORION, Attack 2, 7.4 m/s");
}

TEST(MatchText, ASetThatEndsOnTheClockIsNoGoal) {
  Shown shown;
  shown.stop(wire::Screen::ceremony, false);
  shown.state.last_scorer = 1;
  shown.state.score = {1, 2};
  shown.state.sets = {1, 1};
  shown.hud.goal = {.team = 0, .scorer_rod = 5, .scorer_man = 1, .speed = 7.4f};  // an earlier one
  const CeremonyText text = ceremony_text(shown.hud);
  EXPECT_EQ(text.call, "TIME");
  EXPECT_EQ(text.line, "Set for ▲ VEGA");
  EXPECT_EQ(text.detail, "2 : 1, sets 1 : 1");
}

TEST(MatchText, AGoalThatWinsASetSaysSo) {
  Shown shown;
  shown.stop(wire::Screen::ceremony, true);
  shown.state.last_scorer = 1;
  shown.hud.set_over = true;
  EXPECT_EQ(ceremony_text(shown.hud).line, "Goal and set for ▲ VEGA");
  EXPECT_EQ(ceremony_text(shown.hud).call, "GOAL");
  shown.state.golden_goal = true;
  EXPECT_EQ(ceremony_text(shown.hud).call, "GOLDEN GOAL");
}

// --- the end of a match --------------------------------------------------------------------------

TEST(MatchText, AMatchOfSetsIsToldInSetsWithTheGoalsOfEach) {
  Shown shown;
  shown.stop(wire::Screen::end, true);
  shown.state.last_scorer = 0;
  shown.state.score = {5, 3};
  shown.state.sets = {3, 1};
  shown.hud.sets = {{5, 4}, {2, 5}, {5, 1}, {5, 3}};
  EndText text = end_text(shown.hud, 0);
  EXPECT_EQ(text.title, "● ORION WINS");
  EXPECT_EQ(text.result, (std::array<int, 2>{3, 1}));
  EXPECT_EQ(text.details, std::vector<std::string>{"sets  5:4   2:5   5:1   5:3"});
  EXPECT_EQ(end_text(shown.hud, 1).details,
            std::vector<std::string>{"sets  4:5   5:2   1:5   3:5"});
  shown.hud.sets = {{5, 1}, {5, 3}};  // joined late
  EXPECT_EQ(end_text(shown.hud, 0).details, std::vector<std::string>{"last set 5:3"});
  shown.state.sets = {1, 0};
  text = end_text(shown.hud, 0);
  EXPECT_EQ(text.result, (std::array<int, 2>{5, 3})) << "one set: its goals";
  EXPECT_TRUE(text.details.empty());
}

TEST(MatchText, TheLadderNamesRungOpponentNextRungAndChampion) {
  Shown shown;
  shown.state.mode = number(wire::Mode::ladder);
  shown.state.computer = {false, true};
  shown.state.rung = 2;
  EXPECT_EQ(mode_lines(shown.state, 0),
            (std::array<std::string, 2>{"Rung 3 of 5", "level 3, passer"}));
  shown.stop(wire::Screen::end, true);
  shown.state.sets = {1, 0};
  EXPECT_EQ(end_text(shown.hud, 0).call, "push a rod for the next rung: level 4, passer");
  shown.state.sets = {0, 1};
  shown.state.last_scorer = 1;
  EXPECT_EQ(end_text(shown.hud, 0).call, "push a rod to play again") << "lost";
  shown.state.computer = {true, false};
  shown.state.rung = 4;
  const EndText top = end_text(shown.hud, 0);
  EXPECT_EQ(top.title, "CHAMPION OF THE LADDER");
  EXPECT_EQ(top.details, std::vector<std::string>{"▲ VEGA has beaten every opponent"});
  shown.state.attract = true;
  EXPECT_EQ(mode_lines(shown.state, 0)[0], "") << "computers show a match, nobody climbs";
  EXPECT_EQ(end_text(shown.hud, 0).title, "▲ VEGA WINS");
}

TEST(MatchText, AChallengeTellsWhatIsLeftAndThePoints) {
  Shown shown;
  shown.state.mode = number(wire::Mode::challenge);
  shown.state.timed = true;
  shown.state.seconds_left = 71.4f;
  shown.state.score = {2, 1};
  EXPECT_EQ(mode_lines(shown.state, 0)[0], "Challenge of the day");
  EXPECT_EQ(mode_lines(shown.state, 0)[1], "1:12 left, goals 2 : 1");
  EXPECT_EQ(mode_lines(shown.state, 1)[1], "1:12 left, goals 1 : 2");
}

TEST(MatchText, AreInThePersonsLanguage) {
  use_language("de", CLIENT_CATALOGUES);
  Shown shown;
  shown.stop(wire::Screen::ceremony, false);
  EXPECT_EQ(ceremony_text(shown.hud).call, "ZEIT");
  use_language("ko", CLIENT_CATALOGUES);
  shown.state.mode = number(wire::Mode::ladder);
  shown.state.rung = 2;
  EXPECT_EQ(mode_lines(shown.state, 0)[0], "사다리 5단 중 3단");
  use_language("en", CLIENT_CATALOGUES);
}

// --- the story of sets ---------------------------------------------------------------------------

struct SetStory {
  MatchStory story;
  wire::Snapshot scene = scripted_play(0.35);

  void win(std::uint8_t team, const std::array<std::uint8_t, 2>& score) {
    scene.screen = number(wire::Screen::ceremony);
    scene.score = score;
    wire::EventSnapshot won;
    won.kind = number(wire::EventKind::set_won);
    won.team = team;
    story.update({&won, 1}, scene, 0.01f);
    EXPECT_TRUE(story.set_over());
  }
  void play_on(std::uint8_t server) {
    scene.screen = number(wire::Screen::play);
    scene.score = {0, 0};
    scene.next_server = server;
    story.update({}, scene, 0.01f);
    EXPECT_FALSE(story.set_over());
  }
};

TEST(MatchStory, KeepsTheGoalsOfEachSet) {
  SetStory sets;
  sets.win(0, {5, 3});
  sets.play_on(1);  // the loser of the set
  sets.win(1, {4, 5});
  EXPECT_EQ(sets.story.sets(), (std::vector<std::array<int, 2>>{{5, 3}, {4, 5}}));
}

TEST(MatchStory, ChangesTheSidesOfSetsWithTheirPlayers) {
  SetStory sets;
  sets.win(0, {5, 3});
  sets.play_on(0);  // the loser of the set, now on the other side
  EXPECT_EQ(sets.story.sets(), (std::vector<std::array<int, 2>>{{3, 5}}));
  sets.scene.screen = number(wire::Screen::logo);
  sets.story.update({}, sets.scene, 0.01f);
  EXPECT_TRUE(sets.story.sets().empty()) << "another match";
}

}  // namespace
}  // namespace client
