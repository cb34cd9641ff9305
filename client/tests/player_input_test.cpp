#include "client/player_input.h"

#include <gtest/gtest.h>

#include "scripted_scene.h"
#include "times.h"

namespace client {
namespace {

class PlayerInputTest : public ::testing::TestWithParam<int> {};

TEST_P(PlayerInputTest, AwayFromThePersonSlidesAwayAndToTheRightSwingsFeetToTheOtherGoal) {
  const int team = GetParam();
  PlayerInput player(kScriptedSession, team, foosball::Layout::tournament);
  wire::Snapshot scene = scripted_play(0.0);
  for (auto& rod : scene.rods) rod.slide = rod.angle = 0;
  player.update({}, &scene, kFrame);
  InputEvents events;
  events.mouse_forward = 40;
  events.mouse_right = 20;
  player.update(events, &scene, 2 * kFrame);
  const auto rod = player.rods()[static_cast<std::size_t>(player.active_rod())];
  EXPECT_TRUE(rod.driven);
  EXPECT_GT(rod.slide * foosball::push_sign(team), 0.005);
  // A positive angle swings the feet towards -x (foosball/table.h).
  EXPECT_GT(-rod.angle * foosball::attack_sign(team), 0.05);
}

TEST_P(PlayerInputTest, DrivesTheOwnFourRodsOnlyAndTakesThemOverWhereTheyAre) {
  const int team = GetParam();
  PlayerInput player(kScriptedSession, team, foosball::Layout::tournament);
  const wire::Snapshot scene = scripted_play(0.7);
  player.update({}, &scene, kFrame);
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(player.rods()[i].driven, table.rods[i].team == team) << i;
    if (table.rods[i].team == team) {
      EXPECT_NEAR(player.rods()[i].slide, scene.rods[i].slide, 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothTeams, PlayerInputTest, ::testing::Values(0, 1));

// A rod that another cause moves must not change the hand's targets: the server would take that for
// input.
TEST(PlayerInput, AHandThatRestsSendsItsOwnPlacesWhateverBecomesOfTheRods) {
  PlayerInput player(kScriptedSession, 0, foosball::Layout::tournament);
  wire::Snapshot scene = scripted_play(0.0);
  const auto all_at = [&](float slide, wire::RodSource source) {
    for (auto& rod : scene.rods) rod.slide = slide, rod.source = number(source);
  };
  all_at(0.02f, wire::RodSource::none);
  player.update({}, &scene, kFrame);
  EXPECT_NEAR(player.rods()[0].slide, 0.02, 1e-6) << "it takes them over where they are";
  all_at(0.02f, wire::RodSource::client);
  player.update({}, &scene, 2 * kFrame);
  all_at(0.03f, wire::RodSource::client);  // a ball has moved them
  player.update({}, &scene, 3 * kFrame);
  all_at(-0.05f, wire::RodSource::computer);  // the stand-in computer plays
  player.update({}, &scene, 4 * kFrame);
  for (const int rod : {0, 1, 3, 5}) {
    EXPECT_TRUE(player.rods()[static_cast<std::size_t>(rod)].driven);
    EXPECT_NEAR(player.rods()[static_cast<std::size_t>(rod)].slide, 0.02, 1e-6) << rod;
  }
}

TEST(PlayerInput, TheGoalieRestsWithAHandThatHasDoneNothingForLong) {
  PlayerInput player(kScriptedSession, 0, foosball::Layout::tournament);
  player.set_assists({.goalie_follows = true});
  wire::Snapshot scene = scripted_play(0.0);
  for (auto& rod : scene.rods) rod.slide = 0.0f;
  std::int64_t now = 0;
  const auto seconds = [&](double s, float ball, const InputEvents& events = {}) {
    scene.ball.position = {0.1f, ball, 0.0173f};
    scene.ball.linear_velocity = {-1.5f, 0.0f, 0.0f};
    for (const std::int64_t end = now + static_cast<std::int64_t>(1e6 * s); now < end;)
      player.update(events, &scene, now += kFrame);
    return player.rods()[0].slide;
  };
  EXPECT_GT(seconds(2.0, 0.08f), 0.05f);
  EXPECT_LT(seconds(6.0, -0.08f), -0.05f);
  const float rests = seconds(4.0, -0.08f);
  EXPECT_EQ(seconds(2.0, 0.08f), rests) << "nobody is there to help";
  InputEvents wheel;
  wheel.key_slide = 1.0;
  EXPECT_GT(seconds(2.0, 0.08f, wheel), 0.05f);
}

TEST(PlayerInput, NumbersChooseTheLineFromTheOwnGoalOutwards) {
  const auto lines = foosball::rods_of_team(foosball::table_spec(foosball::Layout::tournament), 1);
  PlayerInput player(kScriptedSession, 1, foosball::Layout::tournament);
  for (int line = 0; line < 4; ++line) {
    InputEvents events;
    events.choose_line = line;
    player.update(events, nullptr, (line + 1) * kFrame);
    EXPECT_EQ(player.active_rod(), lines[static_cast<std::size_t>(line)]);
  }
}

TEST(PlayerInput, NumberKeysReachEachCharacterOfTheSelection) {
  wire::Snapshot scene = scripted_play(0);
  scene.screen = number(wire::Screen::selection);
  PlayerInput player(kScriptedSession, 0, foosball::Layout::tournament);
  foosball::Characters twelve = foosball::built_in_characters();
  const int built_in = static_cast<int>(twelve.size());
  ASSERT_EQ(built_in, 6);
  const auto chosen = [&](int key, int now) {
    InputEvents events;
    events.number = key;
    scene.character[0] = static_cast<std::uint8_t>(now);
    player.update(events, &scene, kFrame);
    return player.requests().size() == 1 ? static_cast<int>(player.requests()[0].value) : -1;
  };
  for (int i = 0; i < built_in; ++i) EXPECT_EQ(chosen(i + 1, i == 0 ? 1 : 0), i);
  EXPECT_EQ(chosen(7, 0), -1) << "there is none";
  while (twelve.size() < 12) twelve.push_back(twelve.front());
  player.set_characters(twelve);
  EXPECT_EQ(chosen(9, 0), 8);
  EXPECT_EQ(chosen(10, 0), 9) << "0 is the tenth";
  InputEvents beyond;
  beyond.wheel = 1;
  scene.character[0] = 0;
  player.update(beyond, &scene, kFrame);
  ASSERT_EQ(player.requests().size(), 1u);
  EXPECT_EQ(player.requests()[0].value, 11) << "and the wheel goes on past the tenth";
}

TEST(PlayerInput, PushStartsOnTheLogoAndDoesNothingInPlay) {
  PlayerInput player(kScriptedSession, 0, foosball::Layout::tournament);
  wire::Snapshot scene = scripted_play(0);
  InputEvents events;
  events.push = true;
  scene.screen = 0;
  player.update(events, &scene, kFrame);
  ASSERT_EQ(player.requests().size(), 1u);
  EXPECT_EQ(player.requests()[0].kind, 0);
  scene.screen = 2;
  player.update(events, &scene, 2 * kFrame);
  EXPECT_TRUE(player.requests().empty());
}

TEST(PlayerInput, PauseAsksForTheOppositeOfWhatIs) {
  PlayerInput player(kScriptedSession, 0, foosball::Layout::tournament);
  wire::Snapshot scene = scripted_play(0);
  InputEvents events;
  events.toggle_pause = true;
  player.update(events, &scene, kFrame);
  ASSERT_EQ(player.requests().size(), 1u);
  EXPECT_EQ(player.requests()[0].value, 1);
  scene.paused = true;
  player.update(events, &scene, 2 * kFrame);
  ASSERT_EQ(player.requests().size(), 1u);
  EXPECT_EQ(player.requests()[0].value, 0);
}

TEST(PlayerInput, AHeldArrowChoosesOneCharacterNotMany) {
  PlayerInput player(kScriptedSession, 0, foosball::Layout::tournament);
  wire::Snapshot scene = scripted_play(0);
  scene.screen = 1;
  scene.character = {0, 0};
  InputEvents events;
  events.key_spin = 1;
  player.update(events, &scene, kFrame);
  ASSERT_EQ(player.requests().size(), 1u);
  EXPECT_EQ(player.requests()[0].kind, 1);
  EXPECT_EQ(player.requests()[0].value, 1);
  player.update(events, &scene, 2 * kFrame);
  EXPECT_TRUE(player.requests().empty());
}

TEST(PlayerInput, TheRodsOfAnotherMatchAreNotTakenForItsBeginning) {
  PlayerInput player(kScriptedSession, 0, foosball::Layout::tournament);
  wire::Snapshot old_match = scripted_play(0.7), match = scripted_play(0.2);
  old_match.session = kScriptedSession + 1;
  old_match.screen = 0;
  InputEvents events;
  events.mouse_forward = 40;
  events.push = true;
  for (const wire::Snapshot* scene : {static_cast<const wire::Snapshot*>(nullptr),
                                      static_cast<const wire::Snapshot*>(&old_match)}) {
    player.update(events, scene, kFrame);
    EXPECT_FALSE(player.begun());
    EXPECT_TRUE(player.requests().empty());
    for (const wire::InputRod& rod : player.rods()) EXPECT_FALSE(rod.driven);
  }
  player.update({}, &match, 2 * kFrame);
  EXPECT_TRUE(player.begun());
  const auto active = static_cast<std::size_t>(player.active_rod());
  EXPECT_TRUE(player.rods()[active].driven);
  EXPECT_NEAR(player.rods()[active].slide, match.rods[active].slide, 1e-6);
  EXPECT_NEAR(player.rods()[active].angle, match.rods[active].angle, 1e-6);
  // A late snapshot of the old match moves nothing, and input during that match is discarded.
  player.update(events, &old_match, 3 * kFrame);
  EXPECT_NEAR(player.rods()[active].slide, match.rods[active].slide, 1e-6);
}

}  // namespace
}  // namespace client
