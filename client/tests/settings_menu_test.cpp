#include "client/settings_menu.h"

#include <gtest/gtest.h>

#include "scripted_scene.h"

namespace client {
namespace {

int row_of(const SettingsMenu& menu, const Settings& settings, const std::string& label) {
  const auto rows = menu.rows(settings);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].label == label) return static_cast<int>(i);
  }
  return -1;
}

void go_to(SettingsMenu& menu, Settings& settings, const std::string& label) {
  menu.step({.down = row_of(menu, settings, label) - menu.row()}, 0, settings);
}

TEST(SettingsMenu, EveryRowButTheControlsAndNamesChangesAndComesBack) {
  SettingsMenu menu;
  menu.toggle();
  Settings settings;
  const int rows = static_cast<int>(menu.rows(settings).size()) - kActions;
  for (int row = 0; row < rows; ++row) {
    if (menu.at_name()) {
      EXPECT_FALSE(menu.step({.right = 1}, 0, settings));
      menu.step({.down = 1}, 0, settings);
      continue;
    }
    const std::string before = format_settings(settings);
    EXPECT_TRUE(menu.step({.right = row == 0 ? -1 : 1}, 0, settings)) << row;
    EXPECT_NE(format_settings(settings), before)
        << menu.rows(settings)[static_cast<std::size_t>(row)].label;
    menu.step({.right = row == 0 ? 1 : -1}, 0, settings);
    EXPECT_EQ(format_settings(settings), before) << row;
    menu.step({.down = 1}, 0, settings);
  }
}

TEST(SettingsMenu, AControlTakesTheNextKeyAndNoOtherActionKeepsIt) {
  SettingsMenu menu;
  menu.toggle();
  Settings settings;
  go_to(menu, settings, "Push");
  menu.step({.confirm = true}, 0, settings);
  EXPECT_TRUE(menu.waits_for_key());
  EXPECT_FALSE(menu.step({.down = 1}, 0, settings));  // waits for the key
  EXPECT_TRUE(menu.step({}, 'P', settings));
  EXPECT_FALSE(menu.waits_for_key());
  EXPECT_EQ(settings.keys[index_of(Action::push)][0], 'P');
  EXPECT_EQ(settings.keys[index_of(Action::pause)][0], 0);
  menu.step({.confirm = true}, 0, settings);
  EXPECT_FALSE(menu.step({.back = true}, 0, settings));
  EXPECT_TRUE(menu.open());
  menu.step({.back = true}, 0, settings);
  EXPECT_FALSE(menu.open());
}

TEST(SettingsMenu, ANameIsTypedAndKeptByEnterAlone) {
  SettingsMenu menu;
  menu.toggle();
  Settings settings;
  go_to(menu, settings, "Name of player");
  const auto row = static_cast<std::size_t>(menu.row());
  EXPECT_EQ(menu.rows(settings)[row].value, "player");
  EXPECT_EQ(menu.rows(settings)[row + 1].value, "player 2");
  EXPECT_FALSE(menu.step({.confirm = true, .text = "\r"}, 0, settings));
  EXPECT_TRUE(menu.waits_for_key());
  EXPECT_FALSE(menu.step({.text = "J\xC3\xBC"}, 'J', settings));
  EXPECT_FALSE(menu.step({.text = "\bo x\b"}, 0, settings)) << "a letter of two bytes goes whole";
  EXPECT_EQ(menu.rows(settings)[row].value, "Jo _");
  EXPECT_TRUE(menu.step({.text = "\r"}, 0, settings));
  EXPECT_FALSE(menu.waits_for_key());
  EXPECT_EQ(settings.names[0], "Jo");
  // Unchanged after Esc, and after an Enter without a change.
  menu.step({.confirm = true}, 0, settings);
  menu.step({.text = "hn"}, 0, settings);
  EXPECT_FALSE(menu.step({.back = true}, 0, settings));
  EXPECT_TRUE(menu.open());
  EXPECT_EQ(settings.names[0], "Jo");
  menu.step({.confirm = true}, 0, settings);
  EXPECT_FALSE(menu.step({.text = "\r"}, 0, settings));
  // An empty name resets it to the default; a name is limited to the length in a message.
  menu.step({.confirm = true}, 0, settings);
  EXPECT_TRUE(menu.step({.text = "\b\b\b\b\r"}, 0, settings));
  EXPECT_EQ(menu.rows(settings)[row].value, "player");
  menu.step({.confirm = true}, 0, settings);
  EXPECT_TRUE(menu.step({.text = std::string(100, 'a') + "\r"}, 0, settings));
  EXPECT_EQ(settings.names[0], std::string(64, 'a'));
}

TEST(MenuHand, KeysMouseAndRodsMakeTheSameSteps) {
  wire::Snapshot scene = scripted_play(0.0);
  for (auto& rod : scene.rods) rod.slide = rod.angle = 0;
  for (const int team : {0, 1}) {
    MenuHand hand;
    InputEvents keys;
    keys.presses[index_of(Action::slide_near)] = 1;
    keys.presses[index_of(Action::spin_left)] = 1;
    MenuSteps steps = hand.steps(keys, &scene, team);
    EXPECT_EQ(steps.down, 1);
    EXPECT_EQ(steps.right, -1);
    InputEvents mouse;
    mouse.mouse_forward = -70;
    mouse.mouse_right = 130;
    steps = hand.steps(mouse, &scene, team);
    EXPECT_EQ(steps.down, 1);
    EXPECT_EQ(steps.right, 2);
    wire::Snapshot moved = scene;
    const int rod =
        foosball::rods_of_team(foosball::table_spec(foosball::Layout::tournament), team)[1];
    auto& own = moved.rods[static_cast<std::size_t>(rod)];
    own.angle = static_cast<float>(-foosball::attack_sign(team) * 0.8);
    own.slide = static_cast<float>(foosball::push_sign(team) * -0.05);
    steps = hand.steps({}, &moved, team);
    EXPECT_EQ(steps.down, 1);
    EXPECT_EQ(steps.right, -1);
    steps = hand.steps({}, &moved, team);  // an unmoved rod makes no more steps
    EXPECT_EQ(steps.down, 0);
    EXPECT_EQ(steps.right, 0);
  }
}

}  // namespace
}  // namespace client
