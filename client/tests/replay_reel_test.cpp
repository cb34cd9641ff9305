#include "core/replay_reel.h"

#include <gtest/gtest.h>

#include "foosball/rules.h"
#include "scripted_scene.h"
#include "times.h"
#include "wire/enums.h"

namespace client {
namespace {

// In a ceremony of 4 s: from 0.75 s before the goal to 0.2 s after it, at 0.3 times the speed.
TEST(ReplayReel, ShowsTheGoalAgainInSlowMotionAndEndsWithinTheCeremony) {
  ReplayReel reel;
  std::int64_t now = 0;
  wire::Snapshot scene = scripted_play(0.0);
  for (int i = 0; i < 200; ++i, now += kFrame) {
    scene.ball.position[0] = 1e-6f * static_cast<float>(now);  // [m] equals [s]: encodes the time
    scene.ball.linear_velocity = {1, 0, 0};
    reel.record(scene, now);
    EXPECT_FALSE(reel.showing(now));
  }
  const std::int64_t goal = now;
  reel.mark_goal(goal);
  for (; now < goal + 350'000; now += kFrame) {
    EXPECT_FALSE(reel.showing(now)) << "the ball runs into the goal first";
    scene.ball.position[0] = 1e-6f * static_cast<float>(now);
    reel.record(scene, now);
  }
  float last = 0.0f;
  int frames = 0;
  for (; reel.showing(now); now += kFrame, ++frames) {
    const float at = reel.scene(now).ball.position[0];
    if (frames == 0) {
      EXPECT_NEAR(at, 1e-6 * static_cast<double>(goal) - 0.75, 0.02);
    } else {
      EXPECT_NEAR(at - last, 0.3 / 60.0, 1e-4) << frames;
    }
    last = at;
  }
  EXPECT_NEAR(static_cast<double>(frames) / 60.0, 0.95 / 0.3, 0.06);
  EXPECT_NEAR(last, 1e-6 * static_cast<double>(goal) + 0.2, 0.02) << "the ball is seen in the goal";
  const double ceremony = foosball::arcade_rules().ceremony_seconds;
  EXPECT_EQ(ceremony, 4.0);
  EXPECT_LT(1e-6 * static_cast<double>(now - goal), ceremony - 0.3) << "and so is the table then";
}

TEST(ReplayReel, IsSkippedAndNeedsAGoal) {
  ReplayReel reel;
  for (int i = 0; i < 100; ++i) reel.record(scripted_play(0.016 * i), i * kFrame);
  const std::int64_t now = 100 * kFrame;
  EXPECT_FALSE(reel.showing(now));
  reel.mark_goal(now);
  EXPECT_TRUE(reel.showing(now + ReplayReel::kWaitUs + kFrame));
  reel.skip();
  EXPECT_FALSE(reel.showing(now + ReplayReel::kWaitUs + kFrame));
}

// Whether a replay was shown within the four seconds after the play.
bool shown_again(wire::Screen next, bool ball_in_goal) {
  ReplayReel reel;
  bool shown = false;
  for (int i = 0; i < 420; ++i) {
    wire::Snapshot scene = scripted_play(i / 60.0);
    if (i >= 180) {
      scene.screen = number(next);
      scene.ball_in_play = false;
      scene.ball_visible = ball_in_goal;
    }
    shown = reel.follow(scene, i * kFrame) || shown;
  }
  return shown;
}

TEST(ReplayReel, ASetThatEndsOnTheClockIsNotShownAgainAndAGoalIs) {
  for (const wire::Screen next : {wire::Screen::ceremony, wire::Screen::end}) {
    EXPECT_TRUE(shown_again(next, true));
    EXPECT_FALSE(shown_again(next, false));
  }
}

}  // namespace
}  // namespace client
