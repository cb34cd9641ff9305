#include "cabinet/hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

using namespace cabinet;

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

struct Player {
  static HandOptions options() {
    HandOptions o;
    o.slide_limit = {0.2, 0.18, 0.1, 0.15};
    return o;
  }
  Hand hand{options()};
  std::int64_t now_us = 1'000'000;

  Player() { hand.poll(now_us); }
  void frames(int count, std::int64_t period_us = 16'667) {
    for (int i = 0; i < count; ++i) hand.poll(now_us += period_us);
  }
  const RodInput& rod(int index) const { return hand.rods()[index]; }
  const RodInput& active() const { return rod(hand.active_rod()); }
};

TEST(Hand, DrivesItsFourRodsAndNoOther) {
  Player p;
  for (int rod = 0; rod < kRods; ++rod) {
    const bool mine = rod == 0 || rod == 1 || rod == 3 || rod == 5;
    EXPECT_EQ(p.rod(rod).status, mine ? RodStatus::live : RodStatus::absent) << rod;
  }
}

TEST(Hand, TheMouseMovesTheActiveRodOnly) {
  Player p;
  ASSERT_EQ(p.hand.active_rod(), 3);
  p.hand.mouse_moved(100, 50);
  p.frames(1);
  EXPECT_NEAR(p.rod(3).slide, 0.06, 1e-12);
  EXPECT_NEAR(p.rod(3).angle, 0.6, 1e-12);
  for (const int other : {0, 1, 5}) {
    EXPECT_EQ(p.rod(other).slide, 0);
    EXPECT_EQ(p.rod(other).angle, 0);
  }
  p.hand.choose(0);
  p.hand.mouse_moved(-10, 0);
  p.frames(1);
  EXPECT_NEAR(p.rod(0).slide, -0.006, 1e-12);
  EXPECT_NEAR(p.rod(3).slide, 0.06, 1e-12);  // stays where the hand left it
  EXPECT_EQ(p.rod(3).status, RodStatus::live);
}

TEST(Hand, StandsWithTheFirstFrameThatBringsNothing) {
  Player p;
  for (int frame = 0; frame < 10; ++frame) {
    p.hand.mouse_moved(10, 10);
    p.frames(1);
    EXPECT_GT(p.active().slide_rate, 0.3);
    EXPECT_NE(p.active().angle_rate, 0);
  }
  p.frames(1);
  EXPECT_EQ(p.active().slide_rate, 0);
  EXPECT_EQ(p.active().angle_rate, 0);
}

TEST(Hand, MovesOnBetweenTheReportsOfASlowMouse) {
  Player p;
  constexpr std::int64_t kFrameUs = 4'167, kReportUs = 8'000;  // 240 Hz, 125 Hz
  std::int64_t next_us = p.now_us + kReportUs;
  for (int frame = 0; frame < 480; ++frame) {
    for (; next_us <= p.now_us + kFrameUs; next_us += kReportUs) p.hand.mouse_moved(0, 16);
    p.frames(1, kFrameUs);
    if (frame < 10) continue;
    const double steady = 16 * HandOptions{}.radians_per_pixel / (1e-6 * kReportUs);
    EXPECT_NEAR(std::abs(p.active().angle_rate) / steady, 1.0, 0.55) << frame;  // measured 0.50
  }
}

TEST(Hand, SignsTurnTheMotionRound) {
  HandOptions options = Player::options();
  options.slide_sign = options.angle_sign = -1;
  Hand hand(options);
  hand.mouse_moved(10, 10);
  hand.poll(0);
  EXPECT_LT(hand.rods()[3].slide, 0);
  EXPECT_LT(hand.rods()[3].angle, 0);
}

TEST(Hand, SlideStopsAtItsLimitWithoutWindUpAndTheAngleTurnsOn) {
  Player p;
  p.hand.mouse_moved(10'000, 10'000);
  p.frames(1);
  EXPECT_EQ(p.active().slide, 0.1);
  EXPECT_NEAR(p.active().angle, 120, 1e-9);  // 19 turns
  p.hand.mouse_moved(-10, 0);
  p.frames(1);
  EXPECT_NEAR(p.active().slide, 0.1 - 0.006, 1e-12);  // reverses at once
}

TEST(Hand, RatesAreThoseOfTheMotionAndFallToZero) {
  Player p;
  for (int i = 0; i < 8; ++i) {
    p.hand.mouse_moved(10, -20);
    p.frames(1, 10'000);  // 6 mm and -0.24 rad in 10 ms
  }
  EXPECT_NEAR(p.active().slide_rate, 0.6, 1e-6);
  EXPECT_NEAR(p.active().angle_rate, -24, 1e-4);
  p.frames(5, 10'000);
  EXPECT_EQ(p.active().slide_rate, 0);
  EXPECT_EQ(p.active().angle_rate, 0);
}

TEST(Hand, WheelAndKeysChooseARodAndStopAtTheEnds) {
  Player p;
  p.hand.cycle(1);
  EXPECT_EQ(p.hand.active_line(), 3);
  p.hand.cycle(1);
  EXPECT_EQ(p.hand.active_line(), 3);
  p.hand.cycle(-2'000'000'000);
  EXPECT_EQ(p.hand.active_line(), 0);
  for (const int ignored : {-1, 4, 99}) p.hand.choose(ignored);
  EXPECT_EQ(p.hand.active_line(), 0);
  p.hand.choose(1);
  EXPECT_EQ(p.hand.active_rod(), 1);
}

TEST(Hand, AdoptedPositionsAreTakenUntilTheHandMovesTheRod) {
  Player p;
  p.hand.adopt(3, 0.05, 1.5);
  p.hand.adopt(5, -0.08, 7.0);
  p.hand.adopt(2, 0.05, 1.0);  // not a rod of this hand
  p.frames(1);
  EXPECT_EQ(p.rod(3).slide, 0.05);
  EXPECT_EQ(p.rod(3).slide_rate, 0);  // adopted, not moved
  EXPECT_EQ(p.rod(5).angle, 7.0);
  EXPECT_EQ(p.rod(2).status, RodStatus::absent);

  p.hand.mouse_moved(10, 0);
  p.hand.adopt(3, -0.02, 0);  // an old snapshot does not move the rod back
  p.frames(1);
  EXPECT_NEAR(p.rod(3).slide, 0.056, 1e-12);
  EXPECT_EQ(p.rod(3).angle, 1.5);

  p.hand.release();
  p.hand.adopt(3, -0.02, 0);
  p.frames(1);
  EXPECT_EQ(p.rod(3).slide, -0.02);
}

TEST(Hand, AHeldKeyRampsUpAndStopsWhenLetGo) {
  Player p;
  p.hand.choose(0);
  p.hand.key_axis(1, 0);
  p.frames(1, 10'000);
  const double first = p.active().slide;
  EXPECT_GT(first, 0);
  EXPECT_LT(first, 0.002);  // a tap is a nudge
  p.frames(12, 10'000);
  EXPECT_NEAR(p.active().slide_rate, 1.2, 0.01);
  p.hand.key_axis(0, 0);
  const double stopped = p.active().slide;
  p.frames(10, 10'000);
  EXPECT_EQ(p.active().slide, stopped);
  EXPECT_EQ(p.active().slide_rate, 0);
}

TEST(Hand, ATapBetweenTwoPollsMovesTheRodByTheStatedAmount) {
  for (const std::int64_t period_us : {4'167, 16'667, 100'000}) {
    Player p;
    p.hand.choose(0);
    p.hand.key_taps(1, 0);
    p.frames(1, period_us);
    EXPECT_NEAR(p.active().slide, kTapSlide, 1e-12) << period_us;
    p.hand.key_taps(-2, 0);
    p.frames(1, period_us);
    EXPECT_NEAR(p.active().slide, -kTapSlide, 1e-12) << period_us;
    p.hand.key_taps(0, 0);
    p.frames(3, period_us);
    EXPECT_NEAR(p.active().slide, -kTapSlide, 1e-12) << period_us;

    p.hand.key_taps(0, 1);
    p.frames(1, period_us);
    EXPECT_NEAR(p.active().angle, kSwing, 1e-12) << period_us;
    p.hand.key_taps(0, 0);
    p.frames(10, period_us);
    EXPECT_EQ(p.active().angle, 0) << period_us;
  }
}

TEST(Hand, AHeldKeyMovesAsFarAtTenFramesASecondAsAtSixty) {
  double way[2] = {};
  for (int i = 0; i < 2; ++i) {
    Player p;
    p.hand.choose(0);
    p.hand.key_axis(1, 0);
    p.frames(i == 0 ? 12 : 2, i == 0 ? 16'667 : 100'000);
    way[i] = p.active().slide;
  }
  EXPECT_NEAR(way[1] / way[0], 1.0, 0.35);  // larger steps integrate the ramp more coarsely
}

TEST(Hand, ASpinKeyFlicksAndReturnsToTheNearestHangingAngle) {
  Player p;
  p.hand.adopt(3, 0, kTurn + 0.3);
  p.hand.key_axis(0, -1);
  p.frames(10);
  EXPECT_NEAR(p.active().angle, kTurn - 1.4, 1e-9);
  p.hand.key_axis(0, 1);
  p.frames(1, 10'000);
  EXPECT_NEAR(p.active().angle, kTurn - 0.8, 1e-9);  // 60 rad/s
  p.frames(10);
  EXPECT_NEAR(p.active().angle, kTurn + 1.4, 1e-9);
  p.hand.key_axis(0, 0);
  p.frames(10);
  EXPECT_EQ(p.active().angle, kTurn);
}

TEST(Hand, ARodLeftInAFlickReturnsByItself) {
  Player p;
  p.hand.key_axis(0, 1);
  p.frames(5);
  p.hand.choose(0);
  p.frames(10);
  EXPECT_EQ(p.rod(3).angle, 0);
  EXPECT_NEAR(p.rod(0).angle, 1.4, 1e-9);
}

TEST(Hand, TheLeftStickSlidesByRateOutsideItsDeadZone) {
  Player p;
  p.hand.choose(0);
  p.hand.pad({.left_x = 0.1f});
  p.frames(10);
  EXPECT_EQ(p.active().slide, 0);
  p.hand.pad({.left_y = 1.0f});
  p.frames(10, 10'000);
  EXPECT_NEAR(p.active().slide, 0.15, 1e-9);
  p.hand.pad({});
  p.frames(10);
  EXPECT_NEAR(p.active().slide, 0.15, 1e-9);
}

TEST(Hand, TheRightStickIsTheAngle) {
  Player p;
  p.hand.pad({.right_y = -1.0f});
  p.frames(5);
  EXPECT_NEAR(p.active().angle, -1.4, 1e-6);
  p.hand.pad({.right_y = 1.0f});
  p.frames(2, 10'000);
  EXPECT_NEAR(p.active().angle, 1.4, 1e-6);  // 2.8 rad in 20 ms: a shot
  p.hand.pad({.right_y = 0.56f});
  p.frames(1);
  EXPECT_NEAR(p.active().angle, 0.7, 1e-6);
  p.hand.pad({});
  p.frames(1);
  EXPECT_EQ(p.active().angle, 0);
}

TEST(Hand, AShoulderButtonChangesTheRodOncePerPress) {
  Player p;
  for (int i = 0; i < 5; ++i) p.hand.pad({.previous_rod = true});
  EXPECT_EQ(p.hand.active_line(), 1);
  p.hand.pad({});
  p.hand.pad({.next_rod = true});
  EXPECT_EQ(p.hand.active_line(), 2);
}

TEST(Hand, OfATeamThatIsSharedOnlyTheOwnRodsAreChosenAndLive) {
  HandOptions options;
  options.slide_limit = {0.2, 0.2, 0.2, 0.2};
  options.has = {true, false, false, true};
  Hand hand(options);
  EXPECT_EQ(hand.active_line(), 0);  // its first rod from the midfield towards the own goal
  hand.choose(2);
  EXPECT_EQ(hand.active_line(), 0);
  hand.cycle(1);
  EXPECT_EQ(hand.active_line(), 3);
  hand.cycle(1);
  EXPECT_EQ(hand.active_line(), 3);
  hand.cycle(-4);
  EXPECT_EQ(hand.active_line(), 0);
  hand.poll(1000);
  for (int i = 0; i < 4; ++i) {
    const RodStatus status = hand.rods()[static_cast<std::size_t>(options.rods[i])].status;
    EXPECT_EQ(status == RodStatus::live, options.has[i]) << i;
  }
}

TEST(Hand, GoesOnFromWhereARodWasPlaced) {
  Player p;
  const int rod = p.hand.active_rod();
  p.hand.place(rod, 0.05, 0.4);
  p.frames(1);
  EXPECT_NEAR(p.hand.rods()[static_cast<std::size_t>(rod)].slide, 0.05, 1e-12);
  EXPECT_EQ(p.hand.rods()[static_cast<std::size_t>(rod)].slide_rate, 0.0);  // not a motion
  p.hand.adopt(rod, -0.1, 0.0);
  p.frames(1);
  EXPECT_NEAR(p.hand.rods()[static_cast<std::size_t>(rod)].slide, 0.05, 1e-12);
}

TEST(Hand, StrikesWhileItHoldsASwing) {
  Player p;
  p.frames(2);
  EXPECT_FALSE(p.hand.strikes());
  p.hand.key_axis(0, -1);
  EXPECT_TRUE(p.hand.strikes());
  p.hand.key_axis(0, 0);
  p.frames(200);
  EXPECT_FALSE(p.hand.strikes());
}

TEST(Hand, NothingNotFiniteComesOut) {
  Player p;
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  const float bad = std::numeric_limits<float>::quiet_NaN();
  p.hand.mouse_moved(nan, infinite);
  p.hand.key_axis(infinite, nan);
  p.hand.pad({.left_x = bad, .left_y = bad, .right_x = bad, .right_y = bad});
  p.hand.adopt(3, nan, infinite);
  p.hand.place(3, nan, infinite);
  p.frames(10);
  p.hand.poll(p.now_us - 1'000'000'000);  // a clock that runs backwards
  for (const RodInput& rod : p.hand.rods()) {
    EXPECT_TRUE(std::isfinite(rod.slide) && std::isfinite(rod.angle));
    EXPECT_TRUE(std::isfinite(rod.slide_rate) && std::isfinite(rod.angle_rate));
  }
}

}  // namespace
