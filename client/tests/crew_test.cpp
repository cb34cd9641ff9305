// Several people at one client, each with separate devices and rods.
#include "client/crew.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/crew_names.h"
#include "core/input_collector.h"
#include "foosball/feed.h"
#include "scripted_scene.h"
#include "times.h"
#include "wire/enums.h"

namespace client {
namespace {

constexpr std::uint8_t kTeam0 = 0b00101011, kAll = 0xff;
constexpr int kPad1 = static_cast<int>(Device::pad_1), kPad2 = static_cast<int>(Device::pad_2);

int key(const char* name) {
  return key_of_name(name);
}

// --- what is collected ---------------------------------------------------------------------------

TEST(InputCollector, PressesThatAreOverBeforeTheFrameCount) {
  InputCollector input;
  input.connect(1, true);
  for (int i = 0; i < 3; ++i) {
    input.button(1, PadButton::next_rod, true);
    input.button(1, PadButton::next_rod, false);
  }
  input.button(1, PadButton::push, true);
  input.button(1, PadButton::push, false);
  const InputEvents events = input.take(bit_of(Device::pad_2));
  EXPECT_EQ(events.wheel, 3);
  EXPECT_TRUE(events.pad_push);
  EXPECT_TRUE(events.has_pad);
  EXPECT_FALSE(input.take(bit_of(Device::pad_1)).pad_push) << "another pad";
  input.clear();
  EXPECT_EQ(input.take(kAllDevices).wheel, 0);
}

TEST(InputCollector, AStickThatIsFlickedBetweenTwoFramesStrikes) {
  InputCollector input;
  input.connect(0, true);
  input.sticks(0, {.right_x = 0.9f});
  input.sticks(0, {.right_x = 0.05f});
  EXPECT_EQ(input.take(kAllDevices).spin_taps, 1);
  input.clear();
  input.sticks(0, {.right_x = -0.9f});
  EXPECT_EQ(input.take(kAllDevices).spin_taps, 0) << "held: the stick itself";
  EXPECT_EQ(input.take(kAllDevices).pad.right_x, -0.9f);
}

TEST(InputCollector, TheTwoHalvesOfTheKeyboardAreTwoDevices) {
  InputCollector input;
  input.key(key("Up"), true);
  input.key(key("A"), true);
  input.mouse_moved(5.0, 7.0);
  const InputEvents arrows = input.take(bit_of(Device::keys_1)),
                    letters = input.take(bit_of(Device::keys_2)), all = input.take(kAllDevices);
  EXPECT_EQ(arrows.key_slide, 1.0);
  EXPECT_EQ(arrows.key_spin, 0.0);
  EXPECT_EQ(letters.key_slide, 0.0);
  EXPECT_EQ(letters.key_spin, -1.0);
  EXPECT_EQ(letters.mouse_right, 0.0);
  EXPECT_EQ(all.key_slide, 1.0);
  EXPECT_EQ(all.key_spin, -1.0);
  EXPECT_EQ(all.mouse_forward, 7.0);
}

TEST(InputCollector, APadThatIsUnpluggedLetsEverythingGo) {
  InputCollector input;
  input.connect(0, true);
  input.sticks(0, {.left_y = 1.0f, .right_x = -1.0f});
  input.connect(0, false);
  input.clear();
  const InputEvents events = input.take(kAllDevices);
  EXPECT_FALSE(events.has_pad);
  EXPECT_EQ(events.pad.left_y, 0.0f);
  EXPECT_EQ(events.pad.right_x, 0.0f);
  input.connect(9, true);  // no such index
  input.button(-1, PadButton::push, true);
}

// --- who plays what ------------------------------------------------------------------------------

struct Table {
  explicit Table(std::uint8_t granted)
      : crew(kScriptedSession, 0, foosball::Layout::tournament, granted) {
    for (auto& rod : scene.rods) rod.slide = rod.angle = 0;
    for (int pad = 0; pad < 2; ++pad) input.connect(pad, true);
    frame();
  }
  void frame() {
    now += kFrame;
    crew.update([&](DeviceSet devices) { return input.take(devices); }, &scene, now);
    input.clear();
  }
  InputCollector input;
  wire::Snapshot scene = scripted_play(0.0);
  Crew crew;
  std::int64_t now = 0;
};

TEST(Crew, OnePersonHasAllDevicesUntilOneIsGivenRods) {
  Table table(kTeam0);
  EXPECT_EQ(table.crew.people(), 1);
  EXPECT_EQ(table.crew.devices_of(Crew::kFirstPerson), kAllDevices);
  for (int rod = 0; rod < 8; ++rod)
    EXPECT_EQ(table.crew.rods()[static_cast<std::size_t>(rod)].driven, (kTeam0 >> rod & 1) != 0);
  table.crew.give(0, kPad1);
  table.crew.give(1, kPad1);
  EXPECT_EQ(table.crew.people(), 2);
  EXPECT_EQ(table.crew.devices_of(Crew::kFirstPerson) & bit_of(Device::pad_1), 0);
}

// Mouse and two gamepads: three people, two teams; each moves only their own active rod.
TEST(Crew, ThreePeopleAtOneClientPlayEachTheirOwnRods) {
  Table table(kAll);
  for (const int rod : {0, 1}) table.crew.give(rod, kPad1);
  for (const int rod : {2, 4, 6, 7}) table.crew.give(rod, kPad2);
  table.frame();
  EXPECT_EQ(table.crew.people(), 3);
  EXPECT_EQ(table.crew.active_rods(), 1u << 3 | 1u << 1 | 1u << 4);
  table.input.mouse_moved(0.0, 40.0);
  table.input.sticks(0, {.left_y = 1.0f});
  table.input.sticks(1, {.left_y = 1.0f});
  for (int i = 0; i < 5; ++i) table.frame();
  const auto rods = table.crew.rods();
  for (int rod = 0; rod < 8; ++rod) {
    const auto& r = rods[static_cast<std::size_t>(rod)];
    EXPECT_TRUE(r.driven) << rod;
    EXPECT_EQ(r.slide != 0.0f, (table.crew.active_rods() >> rod & 1) != 0) << rod;
  }
  EXPECT_GT(rods[1].slide, 0.01f);
  EXPECT_LT(rods[4].slide, -0.01f) << "away from who sits opposite";
}

TEST(Crew, AnUnpluggedPadLeavesItsRodsWhereTheyAre) {
  Table table(kTeam0);
  table.crew.give(0, kPad1);
  table.crew.give(1, kPad1);
  table.input.sticks(0, {.left_y = 1.0f});
  for (int i = 0; i < 5; ++i) table.frame();
  table.input.connect(0, false);
  const auto before = table.crew.rods();
  for (int i = 0; i < 20; ++i) table.frame();
  const auto after = table.crew.rods();
  EXPECT_TRUE(after[1].driven);
  EXPECT_EQ(after[1].slide, before[1].slide);
}

TEST(Crew, RodsThatTheServerGivesToOthersAreDrivenNoMore) {
  Table table(kTeam0);
  table.crew.give(0, kPad1);
  table.crew.grant(0, 0b00101000);
  table.frame();
  EXPECT_FALSE(table.crew.rods()[0].driven);
  EXPECT_FALSE(table.crew.rods()[1].driven);
  EXPECT_TRUE(table.crew.rods()[3].driven);
  table.crew.grant(0, 0);
  table.frame();
  EXPECT_FALSE(table.crew.plays());
  EXPECT_EQ(table.crew.active_rods(), 0);
  table.crew.grant(1, 0b11010100);
  table.frame();
  EXPECT_EQ(table.crew.team(), 1);
  EXPECT_TRUE(table.crew.rods()[4].driven);
}

TEST(Crew, ADeviceThatIsGivenARodOfTheOtherTeamLeavesTheFirst) {
  Table table(kAll);
  table.crew.give(0, kPad1);
  table.crew.give(7, kPad1);
  EXPECT_EQ(table.crew.player_of(0), Crew::kFirstPerson);
  EXPECT_EQ(table.crew.player_of(7), kPad1);
  table.crew.give(12, kPad1);
  table.crew.give(3, 99);  // no such device
  EXPECT_EQ(table.crew.player_of(3), Crew::kFirstPerson);
}

TEST(Crew, EachPersonAsksForTheOwnTeam) {
  Table table(kAll);
  for (const int rod : {2, 4, 6, 7}) table.crew.give(rod, kPad2);
  table.input.button(1, PadButton::time_out, true);
  table.frame();
  ASSERT_EQ(table.crew.requests().size(), 1u);
  EXPECT_EQ(table.crew.requests()[0].kind, number(wire::RequestKind::time_out));
  EXPECT_EQ(table.crew.requests()[0].team, 1);
}

// --- assists -------------------------------------------------------------------------------------

TEST(CrewAssists, TheGoalieFollowsAShotWhileTheHandIsElsewhereAndIsTakenWhereItStands) {
  Table table(kTeam0);
  table.crew.set_assists({.goalie_follows = true});
  table.scene.ball.position = {0.1f, 0.08f, 0.0173f};
  table.scene.ball.linear_velocity = {-1.5f, 0.0f, 0.0f};
  for (int i = 0; i < 20; ++i) table.frame();
  const float goalie = table.crew.rods()[0].slide;
  EXPECT_NEAR(goalie, 0.08f, 0.005f);
  EXPECT_EQ(table.crew.rods()[3].slide, 0.0f);
  table.input.key(key("1"), true);
  table.frame();
  EXPECT_EQ(table.crew.active_rods(), 1);
  EXPECT_NEAR(table.crew.rods()[0].slide, goalie, 1e-6f);
}

TEST(CrewAssists, TheRodThatCanActNextIsTakenAndOneChosenByHandStays) {
  Table table(kTeam0);
  table.crew.set_assists({.automatic_rod = true});
  table.scene.ball.position = {-0.2f, 0.0f, 0.0173f};
  table.scene.ball.linear_velocity = {-3.0f, 0.0f, 0.0f};
  table.frame();
  EXPECT_EQ(table.crew.active_rods(), 1u << 1);
  table.input.key(key("4"), true);
  for (int i = 0; i < 5; ++i) table.frame();
  EXPECT_EQ(table.crew.active_rods(), 1u << 5);
}

TEST(CrewAssists, NoRodIsMovedBetweenPlaysOrInAPause) {
  for (const auto screen : {wire::Screen::selection, wire::Screen::play}) {
    wire::Snapshot scene = scripted_play(0.0);
    for (auto& rod : scene.rods) rod.angle = 1.2f;
    scene.screen = number(screen);
    scene.paused = screen == wire::Screen::play;
    scene.ball.position = {0.3f, 0.1f, 0.0173f};
    Crew crew(kScriptedSession, 0, foosball::Layout::tournament, kTeam0);
    crew.set_assists({true, true, true});
    for (int i = 1; i < 30; ++i)
      crew.update([](DeviceSet) { return InputEvents{}; }, &scene, i * kFrame);
    for (const std::size_t rod : {0u, 1u}) {
      EXPECT_NEAR(crew.rods()[rod].angle, 1.2f, 1e-6f) << rod;
      EXPECT_NEAR(crew.rods()[rod].slide, scene.rods[rod].slide, 1e-6f) << rod;
    }
  }
}

// --- how they are called -------------------------------------------------------------------------

struct NamesTest : testing::Test {
  std::optional<wire::Names> reported(bool in_match = false) {
    return names.update(table.crew, settings, in_match);
  }
  Table table{kAll};
  Settings settings;
  CrewNames names;
};

TEST_F(NamesTest, AreToldOnceAndAgainAfterEachJoin) {
  ASSERT_TRUE(reported());
  EXPECT_FALSE(reported());
  settings.names[0] = "Ann";
  const auto now = reported();
  ASSERT_TRUE(now);
  EXPECT_EQ(now->name, "Ann");
  EXPECT_EQ(now->players, wire::RodPlayers{});
  EXPECT_FALSE(reported());
  EXPECT_EQ(names.set_names()[0], "Ann");
  names.joined();
  EXPECT_TRUE(reported()) << "the seat may have names of before";
}

TEST_F(NamesTest, SeveralPeopleAtOneWindowHaveNamesOfTheirOwn) {
  for (const int rod : {0, 1}) table.crew.give(rod, kPad1);
  for (const int rod : {2, 4, 6, 7}) table.crew.give(rod, kPad2);
  auto now = reported();
  ASSERT_TRUE(now);
  EXPECT_EQ(now->players, (wire::RodPlayers{"player 2", "player 2", "player 3", "", "player 3", "",
                                            "player 3", "player 3"}));
  EXPECT_EQ(names.set_names(), wire::RodPlayers{}) << "nobody has said so";
  settings.names = {"", "Ben", "", ""};
  now = reported();
  ASSERT_TRUE(now);
  EXPECT_EQ(now->players[0], "Ben");
  EXPECT_EQ(now->players[2], "player 3");
  EXPECT_EQ(now->name, "player");
}

// By the rules for leaving, the old name would have lost the match.
TEST_F(NamesTest, NobodyIsRenamedInAMatch) {
  table.crew.give(2, kPad2);
  EXPECT_EQ(reported()->players[2], "player 2");
  settings.names = {"Ann", "Ben", "Cleo", ""};
  EXPECT_FALSE(reported(true));
  // A person joins whose device precedes the others.
  table.crew.give(0, kPad1);
  const auto joined = reported(true);
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->players[0], "player 3");
  EXPECT_EQ(joined->players[2], "player 2") << "as before";
  const auto after = reported();
  ASSERT_TRUE(after);
  EXPECT_EQ(after->name, "Ann");
  EXPECT_EQ(after->players[0], "Ben") << "in the order of the devices again";
  EXPECT_EQ(after->players[2], "Cleo");
}

// --- training ------------------------------------------------------------------------------------

TEST(Crew, InTrainingAKeyOrAPadsButtonChoosesTheNextManOfTheRodInHand) {
  Table table(kTeam0);
  table.scene.screen = number(wire::Screen::play);
  table.scene.mode = number(wire::Mode::training);
  const auto& rods = foosball::table_spec(foosball::Layout::tournament).rods;
  table.scene.feed_rod = 5;
  table.scene.feed_man = 1;
  const auto asked = [&] {
    table.frame();
    const auto requests = table.crew.requests();
    if (requests.empty()) return -1;
    EXPECT_EQ(requests.size(), 1u);
    EXPECT_EQ(requests[0].kind, number(wire::RequestKind::feed));
    EXPECT_EQ(requests[0].team, 0);
    return int{requests[0].value};
  };
  const auto press = [&] {
    table.input.key(key("F"), true);
    table.input.key(key("F"), false);
    return asked();
  };
  table.input.key(key("4"), true);  // the attack, rod 5
  table.input.key(key("4"), false);
  EXPECT_EQ(asked(), -1);
  EXPECT_EQ(press(), foosball::feed_value(foosball::Line::attack, 2));
  // Faster than the server's answer.
  EXPECT_EQ(press(), foosball::feed_value(foosball::Line::attack, 0));
  EXPECT_EQ(press(), foosball::feed_value(foosball::Line::attack, 1));
  table.now += 1'000'000;
  EXPECT_EQ(press(), foosball::feed_value(foosball::Line::attack, 2)) << "as the scene has it";
  // Another rod: its first man.
  table.input.key(key("2"), true);
  table.input.key(key("2"), false);
  asked();
  table.input.button(0, PadButton::share, true);
  EXPECT_EQ(asked(), foosball::feed_value(rods[1].line, 0));
  table.scene.screen = number(wire::Screen::ceremony);
  EXPECT_EQ(press(), foosball::feed_value(rods[1].line, 1));
  table.scene.paused = true;
  EXPECT_EQ(press(), -1);
  table.scene.paused = false;
  table.scene.mode = number(wire::Mode::match);
  EXPECT_EQ(press(), -1) << "in a match nobody is served";
}

TEST(InputCollector, LettersAreUtf8InTheOrderInWhichTheyWereTyped) {
  InputCollector input;
  for (const std::uint32_t letter : {0x41u, 0xFCu, 0xD55Cu, 0x1F600u, 0x0Au, 0x110000u})
    input.letter(letter);
  input.key(key("Backspace"), true);
  input.letter('b');
  input.key(key("Enter"), true);
  EXPECT_EQ(input.take(kAllDevices).text, "A\xC3\xBC\xED\x95\x9C\xF0\x9F\x98\x80\bb\r");
  input.clear();
  EXPECT_EQ(input.take(kAllDevices).text, "");
}

}  // namespace
}  // namespace client
