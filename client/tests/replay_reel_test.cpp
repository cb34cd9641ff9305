#include "core/replay_reel.h"

#include <gtest/gtest.h>

#include "scripted_scene.h"

namespace client {
namespace {

constexpr std::int64_t kFrame = 16'667;

TEST(ReplayReel, ShowsTheGoalAgainSlowerAndEnds) {
  ReplayReel reel;
  std::int64_t now = 0;
  wire::Snapshot scene = scripted_play(0.0);
  for (int i = 0; i < 200; ++i, now += kFrame) {
    scene.ball.position[0] = 1e-6f * static_cast<float>(now);  // [m] for [s]: tells the time
    scene.ball.linear_velocity = {1, 0, 0};
    reel.record(scene, now);
    EXPECT_FALSE(reel.showing(now));
  }
  const std::int64_t goal = now;
  reel.mark_goal(goal);
  for (; now < goal + ReplayReel::kAfterUs; now += kFrame) {
    EXPECT_FALSE(reel.showing(now)) << "the ball runs into the goal first";
    scene.ball.position[0] = 1e-6f * static_cast<float>(now);
    reel.record(scene, now);
  }
  float last = 0.0f;
  int frames = 0;
  for (; reel.showing(now); now += kFrame, ++frames) {
    const float at = reel.scene(now).ball.position[0];
    const std::int64_t begin = goal - ReplayReel::kBeforeUs;
    EXPECT_NEAR(
        at,
        frames == 0 ? 1e-6 * static_cast<double>(begin) : last + 1e-6 * kFrame * ReplayReel::kSpeed,
        frames == 0 ? 0.02 : 1e-4)
        << frames;
    last = at;
  }
  EXPECT_GT(frames, 100);
  EXPECT_GT(last, 1e-6f * static_cast<float>(goal)) << "the ball is seen in the goal";
}

TEST(ReplayReel, IsSkippedAndNeedsAGoal) {
  ReplayReel reel;
  for (int i = 0; i < 100; ++i) reel.record(scripted_play(0.016 * i), i * kFrame);
  const std::int64_t now = 100 * kFrame;
  EXPECT_FALSE(reel.showing(now));
  reel.mark_goal(now);
  EXPECT_TRUE(reel.showing(now + ReplayReel::kAfterUs + kFrame));
  reel.skip();
  EXPECT_FALSE(reel.showing(now + ReplayReel::kAfterUs + kFrame));
}

}  // namespace
}  // namespace client
