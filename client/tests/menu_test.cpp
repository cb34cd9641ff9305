// The pages of the menu: tuning, seats and controllers, without drawing.
#include "client/menu.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "profile/tuning_profile.h"
#include "scripted_scene.h"
#include "times.h"
#include "wire/enums.h"
#include "wire/limits.h"

namespace client {
namespace {

int row_of(const MenuPage& page, const std::string& label) {
  for (std::size_t i = 0; i < page.rows.size(); ++i) {
    if (page.rows[i].label == label) return static_cast<int>(i);
  }
  ADD_FAILURE() << "no row " << label;
  return -1;
}

// --- tuning --------------------------------------------------------------------------------------

class TuningPanel : public testing::Test {
 public:
  ~TuningPanel() override { std::filesystem::remove_all(folder); }

 protected:
  TuningPanel()
      : folder((std::filesystem::path(testing::TempDir()) /
                ("tuning" + std::to_string(::getpid()) +
                 testing::UnitTest::GetInstance()->current_test_info()->name()))
                   .string()),
        menu(folder) {
    std::filesystem::create_directories(folder);
    menu.update(1, reported, true);
  }
  int row(const std::string& label) const { return row_of(menu.page(0), label); }
  // A server that grants every request, for this time; returns the requests.
  std::vector<wire::MatchRequest> grant(std::int64_t long_us, std::uint64_t session = 1) {
    std::vector<wire::MatchRequest> all;
    for (const std::int64_t end = now + long_us; now < end; now += 16'000) {
      for (const wire::MatchRequest& request : menu.requests(now)) {
        all.push_back(request);
        reported.*foosball::kTuningFields[request.value].value = request.amount;
      }
      menu.update(session, reported, true);
    }
    return all;
  }
  std::string folder;
  foosball::Tuning reported;
  std::int64_t now = kSecond;
  TuningMenu menu;
};

TEST_F(TuningPanel, HasEveryValueAndChangesEachWithinItsRange) {
  for (const foosball::TuningField& field : foosball::kTuningFields) {
    for (const int way : {1, -1}) {
      for (int i = 0; i < 400; ++i) menu.step(row(field.name), {.right = way});
      EXPECT_EQ(menu.wanted().*field.value, way > 0 ? field.max : field.min) << field.name;
    }
    menu.step(row(field.name), {.confirm = true});
    EXPECT_EQ(menu.wanted().*field.value, foosball::Tuning{}.*field.value) << field.name;
  }
  EXPECT_TRUE(grant(kSecond).empty()) << "all as they were";
}

TEST_F(TuningPanel, AsksNoFasterThanAServerHearsAndUntilItIsGranted) {
  for (const foosball::TuningField& field : foosball::kTuningFields)
    menu.step(row(field.name), {.right = 1});
  const foosball::Tuning wanted = menu.wanted();
  const auto asked = grant(4 * kSecond);
  EXPECT_EQ(asked.size(), foosball::kTuningFields.size());
  EXPECT_TRUE(reported == wanted);
  EXPECT_GE(4 * kSecond / TuningMenu::kEveryUs, static_cast<std::int64_t>(asked.size()));
  EXPECT_TRUE(grant(kSecond).empty());
}

TEST_F(TuningPanel, GivesUpARequestThatHasNoEffectAndSaysSo) {
  menu.step(row("gravity"), {.right = 1});
  int asked = 0;
  for (int i = 0; i < 600; ++i, now += 16'000) {
    asked += static_cast<int>(menu.requests(now).size());
    menu.update(1, reported, true);
  }
  EXPECT_EQ(asked, TuningMenu::kTries);
  EXPECT_NE(menu.page(0).problem.find("gravity"), std::string::npos);
  EXPECT_TRUE(menu.wanted() == reported);
}

TEST_F(TuningPanel, ForgetsWhatWasWantedOfAServerThatRestarted) {
  menu.step(row("gravity"), {.right = 5});
  menu.update(2, std::nullopt, true);
  EXPECT_TRUE(menu.requests(now).empty());
  menu.update(2, reported, true);
  EXPECT_TRUE(menu.requests(now).empty());
}

TEST_F(TuningPanel, ShowsTheValuesToOthersAndAsksNothingForThem) {
  reported.gravity = 9.5;
  menu.update(1, reported, false);
  for (int i = 0; i < menu.rows(); ++i) {
    if (i == row("Save as this profile")) continue;
    menu.step(i, {.right = 1});
    menu.step(i, {.confirm = true});
  }
  EXPECT_TRUE(menu.requests(now).empty());
  const MenuPage page = menu.page(row("gravity"));
  EXPECT_EQ(page.rows[static_cast<std::size_t>(row("gravity"))].value, "9.5 m/s\u00B2");
  EXPECT_TRUE(page.rows[static_cast<std::size_t>(row("gravity"))].fixed);
}

TEST_F(TuningPanel, WritesValuesInUnitsThatPeopleRead) {
  const MenuPage page = menu.page(row("rolling_resistance"));
  for (const MenuRow& line : page.rows) {
    if (line.share < 0.0f) continue;
    EXPECT_EQ(line.value.find("e-"), std::string::npos) << line.label << " " << line.value;
  }
  const std::string& value = page.rows[static_cast<std::size_t>(row("rolling_resistance"))].value;
  EXPECT_TRUE(value.ends_with(" mm")) << value;
  EXPECT_NE(page.detail.find("[0 .. 2]"), std::string::npos) << page.detail;  // 0.002 m
}

TEST_F(TuningPanel, SavesLoadsAndResets) {
  menu.step(row("gravity"), {.right = 5});
  grant(kSecond);
  const foosball::Tuning mine = reported;
  menu.step(row("Save as this profile"), {.confirm = true});
  menu.step(row("All values to their defaults"), {.confirm = true});
  grant(kSecond);
  EXPECT_TRUE(reported == foosball::Tuning{});
  menu.step(row("Load the profile"), {.confirm = true});
  grant(kSecond);
  EXPECT_TRUE(reported == mine);
  EXPECT_TRUE(profile::load_tuning(folder + "/profile-1.toml").value() == mine);
}

TEST_F(TuningPanel, SaysFileAndLineOfAProfileThatIsNone) {
  std::ofstream(folder + "/a.toml") << "gravity = 9\nhop_gain = \"much\"\n";
  menu.find_profiles();
  menu.step(row("Profile"), {.right = -1});
  ASSERT_EQ(menu.page(0).rows[0].value, "a");
  menu.step(row("Load the profile"), {.confirm = true});
  EXPECT_NE(menu.page(0).problem.find("a.toml:2: hop_gain must be a number"), std::string::npos);
  EXPECT_TRUE(menu.requests(now).empty()) << "nothing of it is taken";
}

// --- seats ---------------------------------------------------------------------------------------

struct SeatsPage {
  SeatsPage() {
    view.client = 1;
    view.role = number(wire::Role::player);
    view.scene = scripted_play(0.0);
    view.scene.screen = number(wire::Screen::play);
    view.scene.time_outs_left = {2, 2};
    view.roster.seats = {{1, "me", 0, 0b00101011, 1, false}, {2, "Ann", 1, 0b11000000, 1, false}};
    view.pads = bit_of(Device::pad_2);
  }
  SeatsAsked at(const std::string& label, const MenuSteps& steps) {
    return menu.step(view, row_of(menu.page(view, crew, 0), label), steps, crew);
  }
  SeatsView view;
  Crew crew{1, 0, foosball::Layout::tournament, 0b00101011};
  SeatsMenu menu;
};

TEST(SeatsMenu, ARodGoesRoundAllDevicesAndToNobody) {
  SeatsPage page;
  std::set<int> players;
  int given_up = 0;
  for (int i = 0; i < 6; ++i) {
    const SeatsAsked asked = page.menu.step(page.view, 0, {.right = 1}, page.crew);
    players.insert(page.crew.player_of(0));
    if (!asked.claim) continue;
    EXPECT_EQ(asked.claim->rods, 0b00101010);
    EXPECT_EQ(asked.claim->team, 0);
    ++given_up;
  }
  // First person, mouse, both halves of the keyboard, and the one pad that is plugged in.
  EXPECT_EQ(players.size(), 5u);
  EXPECT_EQ(given_up, 1);
}

TEST(SeatsMenu, AnotherClientsRodCannotBeTaken) {
  SeatsPage page;
  const SeatsAsked asked = page.menu.step(page.view, 7, {.right = 1}, page.crew);
  EXPECT_FALSE(asked.claim);
  EXPECT_TRUE(page.menu.page(page.view, page.crew, 7).rows[7].fixed);
  EXPECT_EQ(page.menu.page(page.view, page.crew, 7).rows[7].value, "Ann");
}

TEST(SeatsMenu, SidesAreChangedAndRodsGivenUp) {
  SeatsPage page;
  SeatsAsked asked = page.at("Take all free rods of a team", {.confirm = true});
  ASSERT_TRUE(asked.claim);
  EXPECT_EQ(asked.claim->team, 1);
  EXPECT_EQ(asked.claim->rods, 0b00010100) << "those that Ann has not";
  asked = page.at("Give up all rods and watch", {.confirm = true});
  ASSERT_TRUE(asked.claim);
  EXPECT_EQ(asked.claim->rods, 0);
}

TEST(SeatsMenu, VotesAreStartedAndAnswered) {
  SeatsPage page;
  SeatsAsked asked = page.at("Back to the start", {.confirm = true});
  ASSERT_EQ(asked.requests.size(), 1u);
  EXPECT_EQ(asked.requests[0].kind, number(wire::RequestKind::restart));
  asked = page.at("Time-out", {.confirm = true});
  ASSERT_EQ(asked.requests.size(), 1u);
  EXPECT_EQ(asked.requests[0].kind, number(wire::RequestKind::time_out));
  page.view.notices = {{wire::Notice::Level::info, wire::vote_topic(wire::RequestKind::pause, 1),
                        "Ann asks for a pause: 1 of 2 votes"},
                       {wire::Notice::Level::info, 7, "something else"}};
  asked = page.at("Agree to the vote", {.confirm = true});
  ASSERT_EQ(asked.requests.size(), 1u);
  EXPECT_EQ(asked.requests[0].kind, number(wire::RequestKind::pause));
  EXPECT_EQ(asked.requests[0].value, 1);
}

TEST(SeatsMenu, APlayerIsPutOutWhenItIsAskedForTwiceAndNeverAHostOrOneself) {
  SeatsPage page;
  EXPECT_FALSE(page.at("Ann", {.confirm = true}).kick) << "once is a mistake";
  EXPECT_EQ(page.at("Ann", {.confirm = true}).kick.value_or(wire::Kick{}).client, 2u);
  EXPECT_FALSE(page.at("Ann", {.confirm = true}).kick) << "and it begins anew";
  page.at("Time-out", {});
  EXPECT_FALSE(page.at("Ann", {.confirm = true}).kick) << "another row disarms";
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(page.at("me", {.confirm = true}).kick);
  page.view.roster.seats[1].role = number(wire::Role::host);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(page.at("Ann ◆", {.confirm = true}).kick);
  page.view.roster.seats[1] = {2, "Ann", wire::kWatchOnly, 0, 0, false};
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(page.at("Ann", {.confirm = true}).kick) << "watches";
  page.view.notices.push_back({wire::Notice::Level::info, wire::kKickTopics + 2, "1 of 2 votes"});
  EXPECT_FALSE(page.at("Ann", {.confirm = true}).kick);
  EXPECT_EQ(page.at("Ann", {.confirm = true}).kick.value_or(wire::Kick{}).client, 2u)
      << "gave up the rods while the vote was open";
}

TEST(SeatsMenu, NamesStandAtTheRodsOnceMoreThanOnePlays) {
  SeatsPage page;
  EXPECT_EQ(names_at_rods(page.view, page.crew)[7].text, "Ann");
  EXPECT_EQ(names_at_rods(page.view, page.crew)[0].text, "you");
  EXPECT_EQ(names_at_rods(page.view, page.crew)[2].text, "") << "nobody's";
  page.view.roster.seats.pop_back();
  EXPECT_EQ(names_at_rods(page.view, page.crew)[0].text, "") << "alone";
  page.crew.give(0, static_cast<int>(Device::pad_2));
  EXPECT_EQ(names_at_rods(page.view, page.crew)[0].number, 2);
  page.view.own_names[0] = "Ben";
  EXPECT_EQ(names_at_rods(page.view, page.crew)[0].text, "Ben") << "by the name, where it is set";
  EXPECT_FALSE(names_at_rods(page.view, page.crew)[0].translate);
}

TEST(SeatsMenu, TellsPeopleAtOneOtherWindowApart) {
  SeatsPage page;
  page.view.roster.players[7] = "Dora";
  EXPECT_EQ(names_at_rods(page.view, page.crew)[7].text, "Dora");
  EXPECT_EQ(names_at_rods(page.view, page.crew)[6].text, "Ann");
  EXPECT_GE(row_of(page.menu.page(page.view, page.crew, 0), "Ann, Dora"), 0);
}

// --- controllers ---------------------------------------------------------------------------------

class ControllersPage : public testing::Test {
 protected:
  // A controller with 1000 frames per second, of which every 50th is lost; frames are 0.4 ms old
  // when used.
  void report(double seconds) {
    wire::Devices reported{std::llround(1e6 * seconds), {{}}};
    wire::DeviceReport& device = reported.devices[0];
    device.name = "cabinet";
    device.state = number(wire::DeviceState::live);
    device.frames = device.stamped = static_cast<std::uint64_t>(980 * seconds);
    device.lost = static_cast<std::uint64_t>(20 * seconds);
    device.latency_sum_us = 400 * device.frames;
    device.rods[2] = {number(wire::RodStatus::live), std::llround(100 * seconds), -7, 0.0f, 0.0f};
    menu.update(reported);
  }
  DevicesMenu menu;
};

TEST_F(ControllersPage, AsksOnlyAsHostTwentyTimesASecondAndWaitsForAnswers) {
  EXPECT_FALSE(menu.ask(kSecond));
  menu.follow(1, true);
  int asked = 0;
  for (std::int64_t now = kSecond; now < 2 * kSecond; now += 16'000) asked += menu.ask(now) ? 1 : 0;
  EXPECT_EQ(asked, 1) << "no answer has come";
  asked = 0;
  for (std::int64_t now = 2 * kSecond; now < 3 * kSecond; now += 10'000) {
    if (!menu.ask(now)) continue;
    ++asked;
    report(1e-6 * static_cast<double>(now));
  }
  EXPECT_EQ(asked, 20);
  EXPECT_TRUE(menu.ask(4 * kSecond));
  EXPECT_FALSE(menu.ask(4 * kSecond + 900'000));
  EXPECT_TRUE(menu.ask(5 * kSecond + 1)) << "an answer that is lost is not waited for for ever";
  menu.follow(2, false);
  EXPECT_FALSE(menu.ask(9 * kSecond));
}

TEST_F(ControllersPage, RatesAndLatencyAreOfTheLastSecondAndTracesOfTen) {
  menu.follow(1, true);
  for (int i = 20; i <= 20 * 30; ++i) report(0.05 * i);
  const MenuPage page = menu.page(0);
  ASSERT_EQ(page.rows.size(), 1u);
  EXPECT_EQ(page.rows[0].label, "cabinet");
  EXPECT_EQ(page.rows[0].value, "live");
  ASSERT_TRUE(page.device);
  EXPECT_NEAR(page.device->frames_per_second, 980, 5);
  EXPECT_NEAR(page.device->latency_ms, 0.4, 0.01);
  EXPECT_NEAR(static_cast<double>(page.device->lost), 20, 1);
  const auto& trace = page.device->traces[2];
  EXPECT_NEAR(trace.back().seconds - trace.front().seconds, 10, 0.06);
  EXPECT_NEAR(trace.back().slide - trace.front().slide, 1000, 8);
}

TEST_F(ControllersPage, AServerThatCountsFromTheBeginningAgainIsNoBurst) {
  menu.follow(1, true);
  for (int i = 0; i <= 100; ++i) report(100 + 0.05 * i);
  for (int i = 0; i <= 10; ++i) report(1 + 0.05 * i);
  const MenuPage page = menu.page(0);
  EXPECT_NEAR(page.device->frames_per_second, 980, 30);
  EXPECT_EQ(page.device->traces[2].size(), 11u);
}

TEST_F(ControllersPage, SaysWhyNothingIsSeen) {
  menu.follow(1, false);
  EXPECT_NE(menu.page(0).note.find("Only the host"), std::string::npos);
  menu.follow(1, true);
  EXPECT_NE(menu.page(0).note.find("Waiting"), std::string::npos);
  menu.update({1, {}});
  EXPECT_NE(menu.page(0).note.find("--device"), std::string::npos);
  report(1.0);
  report(2.0);
  menu.update({3'000'000, {}});  // all are unplugged
  EXPECT_FALSE(menu.page(3).device);
}

// --- all pages -----------------------------------------------------------------------------------

TEST(Menu, TheFirstRowGoesFromPageToPageWithoutAnyKeyOfTheirOwn) {
  SeatsPage seats;
  Settings settings;
  Menu menu("");
  const Menu::Context context{settings, seats.view, &seats.crew};
  menu.toggle(Menu::Page::settings);
  menu.step({.down = -1}, 0, context);
  std::set<std::string> titles;
  for (int i = 0; i < Menu::kPages; ++i) {
    titles.insert(menu.page(context).title);
    menu.step({.right = 1}, 0, context);
  }
  EXPECT_EQ(titles.size(), static_cast<std::size_t>(Menu::kPages));
  menu.step({.back = true}, 0, context);
  EXPECT_TRUE(menu.page(context).rows.empty());
  menu.toggle(Menu::Page::tuning);
  EXPECT_EQ(menu.page(context).title, "Tuning");
  menu.toggle(Menu::Page::tuning);
  EXPECT_FALSE(menu.open());
}

TEST(Menu, AsksForTheListOfRecordingsAndTurnsRecordingOff) {
  Settings settings;
  const SeatsView nothing;
  Menu menu("");
  const Menu::Context context{settings, nothing, nullptr};
  menu.toggle(Menu::Page::recordings);
  EXPECT_FALSE(menu.step({.right = 1}, 0, context).watch_recordings);
  EXPECT_TRUE(menu.step({.confirm = true}, 0, context).watch_recordings);
  const auto turned = menu.step({.down = 1, .confirm = true}, 0, context);
  EXPECT_TRUE(turned.settings_changed);
  EXPECT_FALSE(turned.watch_recordings);
  EXPECT_FALSE(settings.record_matches);
  EXPECT_NE(format_settings(settings).find("record_matches = no"), std::string::npos);
  EXPECT_EQ(parse_settings(format_settings(settings)).settings, settings);
}

TEST(Menu, StandsWithoutAServer) {
  Settings settings;
  const SeatsView nothing;
  Menu menu("");
  const Menu::Context context{settings, nothing, nullptr};
  for (const auto page : {Menu::Page::settings, Menu::Page::seats, Menu::Page::tuning,
                          Menu::Page::recordings, Menu::Page::game, Menu::Page::controllers}) {
    menu.toggle(page);
    for (int i = 0; i < 80; ++i) menu.step({.down = 1, .confirm = i % 3 == 0}, 0, context);
    EXPECT_FALSE(menu.page(context).rows.empty());
  }
}

TEST(MenuHand, WhatIsHeldRepeatsAndACrossStepsOnce) {
  MenuHand hand;
  InputEvents events;
  events.pad_right = 1;
  events.held_right = 1;
  int steps = hand.steps(events, nullptr, -1, kSecond).right;
  EXPECT_EQ(steps, 1);
  events.pad_right = 0;
  for (std::int64_t now = kSecond; now < 2 * kSecond; now += 16'000)
    steps += hand.steps(events, nullptr, -1, now).right;
  EXPECT_GE(steps, 8);
  EXPECT_LE(steps, 12);
}

}  // namespace
}  // namespace client
