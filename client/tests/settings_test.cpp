#include "client/settings.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace client {
namespace {

Settings unusual() {
  Settings s;
  s.volume = 0.25f;
  s.quality = QualityChoice::high;
  s.text_scale = 1.4f;
  s.reduced_flashes = s.reduced_shake = s.distinct_teams = true;
  s.rods = RodsShown::on;
  s.automatic_rod = s.goalie_follows = s.aim = true;
  s.language = Language::korean;
  s.view = View::above;
  s.handle_offset = {0.01f, -0.02f, 0, 0, 0.06f, 0, 0, -0.06f};
  s.keys[index_of(Action::push)] = {key_of_name("F12"), key_of_name("KeypadEnter")};
  s.keys[index_of(Action::help)] = {0, 0};
  s.names = {"J\xC3\xBCrgen M", "", "= #3", ""};
  return s;
}

TEST(Settings, AreReadAsTheyWereWritten) {
  for (const Settings& s : {Settings{}, unusual()}) {
    const ReadSettings read = parse_settings(format_settings(s));
    EXPECT_TRUE(read.problems.empty()) << read.problems[0];
    EXPECT_EQ(format_settings(read.settings), format_settings(s));
    EXPECT_TRUE(read.settings.keys == s.keys);
    EXPECT_EQ(read.settings.view, s.view);
    EXPECT_EQ(read.settings.names, s.names);
  }
}

TEST(Settings, EveryKeyHasANameOfItsOwn) {
  for (const auto& keys : default_keys()) {
    for (const int key : keys) {
      if (key == 0) continue;
      EXPECT_EQ(key_of_name(name_of_key(key)), key);
    }
  }
  EXPECT_EQ(key_of_name("Escape"), 0);
  EXPECT_EQ(key_of_name(""), 0);
}

TEST(Settings, ABadLineIsNamedWithItsCureAndTheOthersCount) {
  const ReadSettings read = parse_settings(
      "# mine\nvolume = loud\r\ntext_scale = 1.2\n\nview above\nkey.push = Escape\nnonsense = 1\n"
      "volume = nan\nreduced_shake = yes");
  EXPECT_EQ(read.problems.size(), 5u);
  EXPECT_EQ(read.problems[0], "line 2: \"volume\" wants a number from 0 to 1");
  EXPECT_EQ(read.problems[1], "line 5: write \"name = value\"");
  EXPECT_EQ(read.settings.text_scale, 1.2f);
  EXPECT_TRUE(read.settings.reduced_shake);
  EXPECT_EQ(read.settings.volume, Settings{}.volume);
}

TEST(Settings, ANameThatIsNoneIsReportedAndOthersHaveTheirNumber) {
  const ReadSettings read =
      parse_settings("name.1 = Ann\nname.2 = " + std::string(65, 'a') + "\nname.5 = Eve");
  EXPECT_EQ(read.problems.size(), 2u);
  EXPECT_EQ(name_of_person(read.settings, 0), "Ann");
  EXPECT_EQ(name_of_person(read.settings, 1), "player 2");
  EXPECT_EQ(name_of_person(read.settings, 7), "player 8");
  EXPECT_EQ(name_of_person(Settings{}, 0), "player");
}

TEST(Settings, StrangeBytesAreReportedNotTaken) {
  std::string noise;
  std::uint32_t random = 5;
  for (int i = 0; i < 5000; ++i) {
    random = random * 1664525u + 1013904223u;
    noise += static_cast<char>(random >> 24);
  }
  const ReadSettings read = parse_settings(noise);
  EXPECT_LE(read.problems.size(), 8u);
  EXPECT_EQ(read.settings, Settings{});
}

class SettingsFile : public ::testing::Test {
 protected:
  SettingsFile() {
    char name[] = "/tmp/settings-XXXXXX";
    directory = ::mkdtemp(name);
    path = directory + "/space-foosball/client.conf";
  }
  ~SettingsFile() override { std::filesystem::remove_all(directory); }
  static std::string text_of(const std::string& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  std::string directory, path;
};

TEST_F(SettingsFile, IsMadeWithItsDirectoryAndReadBack) {
  EXPECT_EQ(load_settings(path).settings, Settings{});
  ASSERT_TRUE(save_settings(unusual(), path));
  EXPECT_EQ(format_settings(load_settings(path).settings), format_settings(unusual()));
  EXPECT_FALSE(std::filesystem::exists(path + ".bad"));
}

TEST_F(SettingsFile, WhatCouldNotBeReadIsKeptBeside) {
  ASSERT_TRUE(save_settings(unusual(), path));
  std::ofstream(path, std::ios::app) << "volume = eleven\n";
  const ReadSettings read = load_settings(path);
  ASSERT_EQ(read.problems.size(), 1u);
  EXPECT_NE(read.problems[0].find(path + ", line "), std::string::npos);
  ASSERT_TRUE(save_settings(read.settings, path));
  EXPECT_NE(text_of(path + ".bad").find("eleven"), std::string::npos);
  EXPECT_TRUE(load_settings(path).problems.empty());
}

TEST_F(SettingsFile, ThatCannotBeWrittenIsASentence) {
  std::ofstream(directory + "/space-foosball") << "a file where the directory should be";
  const auto saved = save_settings({}, path);
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().find(path), std::string::npos);
  EXPECT_FALSE(save_settings({}, ""));
}

TEST(Settings, RodsAreDrawnWhereTheTableHasThemUnlessTheyAreAskedForOrAway) {
  using enum foosball::Layout;
  EXPECT_FALSE(rods_are_drawn(Settings{}.rods, paper));
  EXPECT_TRUE(rods_are_drawn(Settings{}.rods, tournament));
  for (const foosball::Layout layout : {paper, tournament}) {
    EXPECT_TRUE(rods_are_drawn(RodsShown::on, layout));
    EXPECT_FALSE(rods_are_drawn(RodsShown::off, layout));
  }
  // Files of versions with only two choices.
  EXPECT_EQ(parse_settings("hide_rods = yes\n").settings.rods, RodsShown::off);
  EXPECT_EQ(parse_settings("hide_rods = no\n").settings.rods, RodsShown::as_on_the_table);
}

}  // namespace
}  // namespace client
