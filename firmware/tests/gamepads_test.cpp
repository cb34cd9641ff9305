#include "core/gamepads.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace firmware {
namespace {

struct Sticks {
  int x, y, rx, ry, buttons;
};

// Rod 0 belongs to the left hand and rod 1 to the right hand of the first player. Counts are for a
// travel of 1000 and a turn of 400, unless a test says otherwise.
struct GamepadsTest : testing::Test {
  Gamepads pads;
  wire::DeviceSettings settings;
  std::array<std::uint16_t, 8> slide{}, spin{};
  std::uint16_t now_ms = 65'000;  // wraps soon

  void SetUp() override {
    for (wire::StickScale& stick : settings.sticks) {
      stick.travel = 1000;
      stick.turn = 400;
    }
    begin();
  }
  void begin() {
    for (std::uint8_t rod = 0; rod < 8; ++rod) pads.scale(rod, settings, 80);
    pads.begin();
    pass(1);
  }
  // Every millisecond delivers the counts, which do not change meanwhile.
  void pass(int ms) {
    for (; ms > 0; --ms, ++now_ms)
      for (std::uint8_t rod = 0; rod < 8; ++rod) pads.move(rod, slide[rod], spin[rod], now_ms);
  }
  // Slow enough to press no button.
  void move(std::size_t rod, int slid, int spun) {
    constexpr int kSteps = 40;
    for (int i = 0; i < kSteps; ++i) {
      slide[rod] =
          static_cast<std::uint16_t>(slide[rod] + slid * (i + 1) / kSteps - slid * i / kSteps);
      spin[rod] =
          static_cast<std::uint16_t>(spin[rod] + spun * (i + 1) / kSteps - spun * i / kSteps);
      pass(10);
    }
  }
  Sticks read(std::uint8_t pad) {
    pads.report(pad);
    const std::uint8_t* b = pads.last_report(pad);
    const auto axis = [b](int at) {
      return static_cast<int>(static_cast<std::int16_t>(b[at] | b[at + 1] << 8));
    };
    return {axis(0), axis(2), axis(4), axis(6), b[8] | b[9] << 8};
  }
};

TEST_F(GamepadsTest, BeginInTheMiddleWithNothingPressedWhateverTheCounts) {
  slide.fill(54'321);
  spin.fill(777);
  begin();
  for (std::uint8_t pad = 0; pad < 4; ++pad) {
    const Sticks s = read(pad);
    EXPECT_NEAR(s.y, 0, 40);
    EXPECT_NEAR(s.ry, 0, 40);
    EXPECT_EQ(s.x, 0);
    EXPECT_EQ(s.rx, 0);
    EXPECT_EQ(s.buttons, 0);
  }
}

// Each player has the own goal to the left, so the left hand has the rod closer to it.
TEST_F(GamepadsTest, EachRodIsTheStickOfTheHandThatHoldsIt) {
  struct Place {
    std::size_t rod;
    std::uint8_t pad;
    bool right;
  };
  for (const Place& place :
       {Place{0, 0, false}, Place{1, 0, true}, Place{3, 1, false}, Place{5, 1, true},
        Place{7, 2, false}, Place{6, 2, true}, Place{4, 3, false}, Place{2, 3, true}}) {
    begin();
    move(place.rod, 250, 50);
    for (std::uint8_t pad = 0; pad < 4; ++pad) {
      const Sticks s = read(pad);
      const bool here = pad == place.pad;
      EXPECT_NEAR(s.x, here && !place.right ? 16384 : 0, 100) << place.rod;
      EXPECT_NEAR(s.y, here && !place.right ? -16384 : 0, 100) << place.rod;
      EXPECT_NEAR(s.rx, here && place.right ? 16384 : 0, 100) << place.rod;
      EXPECT_NEAR(s.ry, here && place.right ? -16384 : 0, 100) << place.rod;
    }
  }
}

TEST_F(GamepadsTest, AStopSetsTheStickRightAndBackFromItNothingIsLost) {
  move(0, 5000, 0);
  EXPECT_EQ(read(0).y, -32767) << "up, and no further";
  move(0, -500, 0);
  EXPECT_NEAR(read(0).y, 0, 40) << "from the stop on, not from where the counts were";
  move(0, -800, 0);
  EXPECT_EQ(read(0).y, 32767);
  move(0, 250, 0);
  EXPECT_NEAR(read(0).y, 16384, 40);
}

TEST_F(GamepadsTest, TheSpinFollowsTheAngleToAQuarterTurnAndBackAndJumpsNowhere) {
  for (const int way : {1, -1}) {
    begin();
    int before = 0;
    for (int counts = 1; counts <= 1200; ++counts) {
      spin[0] = static_cast<std::uint16_t>(spin[0] + way);
      pass(2);
      const int x = read(0).x;
      // The expected triangle wave has the zeros and extremes of a sine.
      const double angle = 2 * M_PI * counts / 400;
      const double wanted = way * std::asin(std::sin(angle)) / (M_PI / 2) * 32767;
      ASSERT_NEAR(x, wanted, 4) << counts;
      ASSERT_LE(std::abs(x - before), 330) << counts;
      before = x;
    }
  }
}

TEST_F(GamepadsTest, ARodThatNobodyHoldsHangsAndOneThatTremblesDoesNot) {
  move(0, 100, 100);
  EXPECT_EQ(read(0).x, 32767);
  pass(1900);
  EXPECT_EQ(read(0).x, 32767);
  for (int i = 0; i < 20; ++i) {
    slide[0] = static_cast<std::uint16_t>(slide[0] + (i % 2 ? 1 : -1));
    pass(500);
  }
  EXPECT_EQ(read(0).x, 32767);
  const int y = read(0).y;
  pass(2100);
  EXPECT_EQ(read(0).x, 0);
  EXPECT_EQ(read(0).y, y) << "a rod stays where it was pushed to";
  pass(70'000);
  move(0, 0, 50);
  EXPECT_NEAR(read(0).x, 16384, 100) << "from where it hangs";
}

// 25 rad/s is a shot, not aiming.
TEST_F(GamepadsTest, AFastTurnEitherWayPressesTheButtonOfItsHandLongEnoughForAnyGame) {
  for (const int way : {1, -1}) {
    begin();
    for (int ms = 0; ms < 500; ++ms) {  // 20 rad/s
      spin[1] = static_cast<std::uint16_t>(spin[1] + way * (ms % 4 == 0 ? 5 : 0));
      pass(1);
      EXPECT_EQ(read(0).buttons, 0);
    }
    int pressed = 0;
    for (int ms = 0; ms < 500; ++ms) {  // 40 rad/s, a quarter of a turn
      if (ms < 40) spin[1] = static_cast<std::uint16_t>(spin[1] + way * (ms % 2 == 0 ? 5 : 0));
      pass(1);
      const int buttons = read(0).buttons;
      EXPECT_TRUE(buttons == 0 || buttons == 2) << buttons;
      pressed += buttons != 0;
    }
    EXPECT_GE(pressed, 34) << "two frames of a game at 60 Hz";
    EXPECT_LE(pressed, 120);
  }
}

TEST_F(GamepadsTest, ASensorThatCountsTheOtherWayIsTurnedRound) {
  settings.slide_reversed = 0x02;
  settings.spin_reversed = 0x01;
  begin();
  for (const std::size_t rod : {0u, 1u}) move(rod, 250, 50);
  const Sticks s = read(0);
  EXPECT_NEAR(s.x, -16384, 100);
  EXPECT_NEAR(s.y, -16384, 100);
  EXPECT_NEAR(s.rx, 16384, 100);
  EXPECT_NEAR(s.ry, 16384, 100);
}

TEST_F(GamepadsTest, CountsThatWrapAreFollowed) {
  slide[0] = 65'530;
  spin[0] = 65'530;
  begin();
  move(0, 250, 50);
  EXPECT_NEAR(read(0).y, -16384, 100);
  EXPECT_NEAR(read(0).x, 16384, 100);
}

TEST_F(GamepadsTest, WhatTheHostHasIsNotToldAgainUntilItIsForgotten) {
  EXPECT_NE(pads.report(2), nullptr);
  EXPECT_EQ(pads.report(2), nullptr);
  move(6, 1, 0);
  EXPECT_NE(pads.report(2), nullptr);
  EXPECT_EQ(pads.report(2), nullptr);
  pads.forget_host();
  EXPECT_NE(pads.report(2), nullptr);
}

// Min and max travel and turn, and any counts: never beyond the range.
TEST_F(GamepadsTest, NoCountsLeadOutOfRange) {
  std::mt19937 random(65);
  for (const std::uint16_t counts :
       std::array<std::uint16_t, 6>{64, 65, 127, 4096, 32'767, 65'535}) {
    settings.sticks[0] = {counts, counts};
    begin();
    bool up = false, down = false;
    for (int i = 0; i < 4000; ++i) {
      slide[0] = static_cast<std::uint16_t>(slide[0] + random() % 65'536);
      spin[0] = static_cast<std::uint16_t>(spin[0] + random() % 65'536);
      pass(1);
      const Sticks s = read(0);
      ASSERT_TRUE(s.x >= -32767 && s.x <= 32767 && s.y >= -32767 && s.y <= 32767);
      up |= s.y == -32767;
      down |= s.y == 32767;
    }
    EXPECT_TRUE(up && down) << counts;
  }
}

TEST_F(GamepadsTest, WithoutMeasuredScalesTheTravelIsThatOfTheTable) {
  settings = wire::DeviceSettings();
  begin();
  move(0, 540 * 8 / 4, 0);  // a quarter of the goalkeeper's 540 mm, at 8 counts/mm
  EXPECT_NEAR(read(0).y, -16384, 100);
  move(1, -393 * 8 / 2, 0);
  EXPECT_NEAR(read(0).ry, 32767, 100);
  move(1, 0, 100);  // of 400 counts around a rod of 16 mm
  EXPECT_NEAR(read(0).rx, 32767, 300);
}

}  // namespace
}  // namespace firmware
