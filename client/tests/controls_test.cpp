#include "client/controls.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "client/player_input.h"
#include "scripted_scene.h"

namespace client {
namespace {

TEST(ActionState, ATapBetweenTwoFramesIsCountedAndAHeldKeyIsAnAxis) {
  ActionState keys;
  keys.press(Action::slide_away);
  keys.release(Action::slide_away);
  EXPECT_EQ(keys.axis(Action::slide_away, Action::slide_near), 0.0);
  EXPECT_EQ(keys.tapped(Action::slide_away, Action::slide_near), 1);
  EXPECT_EQ(keys.presses(Action::slide_away), 1);
  keys.clear();
  keys.press(Action::slide_near);
  keys.clear();
  EXPECT_EQ(keys.axis(Action::slide_away, Action::slide_near), -1.0);
  keys.release(Action::slide_near);  // it was held over a frame: the axis has moved the rod
  EXPECT_EQ(keys.tapped(Action::slide_away, Action::slide_near), 0);
  EXPECT_EQ(keys.axis(Action::slide_away, Action::slide_near), 0.0);
}

TEST(ActionState, TwoKeysOfOneActionHoldItUntilBothAreReleased) {
  ActionState keys;
  keys.press(Action::push);
  keys.press(Action::push);
  keys.release(Action::push);
  EXPECT_TRUE(keys.held(Action::push));
  keys.release(Action::push);
  EXPECT_FALSE(keys.held(Action::push));
  keys.release(Action::push);  // never pressed here
  keys.press(Action::push);
  EXPECT_TRUE(keys.held(Action::push));
  keys.release_all();
  EXPECT_FALSE(keys.held(Action::push));
}

// A window with ten frames per second; a person taps a key for 40 ms between two frames.
TEST(ActionState, AShortTapMovesTheRodAtTenFramesASecond) {
  constexpr std::int64_t kFrame = 100'000;
  PlayerInput player(1, 0, foosball::Layout::tournament);
  wire::Snapshot scene = scripted_play(0.0);
  for (auto& rod : scene.rods) rod.slide = rod.angle = 0;
  ActionState keys;
  const auto frame = [&](int i) {
    InputEvents events;
    events.key_slide = keys.axis(Action::slide_away, Action::slide_near);
    events.key_spin = keys.axis(Action::spin_right, Action::spin_left);
    events.slide_taps = keys.tapped(Action::slide_away, Action::slide_near);
    events.spin_taps = keys.tapped(Action::spin_right, Action::spin_left);
    keys.clear();
    player.update(events, &scene, i * kFrame);
    return player.rods()[static_cast<std::size_t>(player.active_rod())];
  };
  frame(1);
  keys.press(Action::slide_away);
  keys.release(Action::slide_away);
  EXPECT_NEAR(frame(2).slide, cabinet::kTapSlide, 1e-6);
  EXPECT_NEAR(frame(3).slide, cabinet::kTapSlide, 1e-6);
  keys.press(Action::spin_right);
  keys.release(Action::spin_right);
  EXPECT_NEAR(std::abs(frame(4).angle), cabinet::kSwing, 1e-6);
  EXPECT_NEAR(frame(5).angle, 0.0, 1e-6);
}

}  // namespace
}  // namespace client
