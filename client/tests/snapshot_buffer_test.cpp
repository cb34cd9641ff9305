#include "client/snapshot_buffer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "scripted_scene.h"
#include "wire/limits.h"

namespace client {
namespace {

using Verdict = SnapshotBuffer::Verdict;

constexpr std::uint64_t kSession = 77;
constexpr std::int64_t kStart = 5'000'000;  // of this process's clock at tick 0 [us]
constexpr double kSpeed = 3.0;              // of the ball along x [m/s]

wire::Snapshot at_tick(std::uint64_t tick) {
  wire::Snapshot s;
  s.session = kSession;
  s.tick = tick;
  s.sequence = tick + 1;
  s.screen = 2;
  s.ball_in_play = true;
  s.ball.position[0] = static_cast<float>(kSpeed * 1e-3 * static_cast<double>(tick));
  s.ball.linear_velocity[0] = static_cast<float>(kSpeed);
  return s;
}

std::int64_t on_time(std::uint64_t tick) {
  return kStart + static_cast<std::int64_t>(tick) * 1000;
}

wire::EventSnapshot event(std::uint32_t id) {
  wire::EventSnapshot e;
  e.id = id;
  return e;
}

class Buffer : public ::testing::Test {
 protected:
  Buffer() { buffer.begin_session(kSession, 1000); }
  Verdict push(std::uint64_t tick) { return buffer.push(at_tick(tick), on_time(tick)); }
  float ball_x(std::int64_t now) { return buffer.sample(now).state.ball.position[0]; }
  SnapshotBuffer buffer;
};

TEST_F(Buffer, HasNothingToShowBeforeTheFirst) {
  EXPECT_FALSE(buffer.sample(kStart).any);
}

TEST_F(Buffer, PlaysOneAndAHalfTicksBehindOnAnEvenNetwork) {
  for (std::uint64_t t = 0; t < 400; ++t) push(t);
  EXPECT_EQ(buffer.delay_us(), 1500);
  const float x = ball_x(on_time(399) + 300);
  EXPECT_NEAR(x, kSpeed * (0.399 + 0.0003 - 0.0015), 2e-6);
}

TEST_F(Buffer, DuplicatesAreCountedAndChangeNothing) {
  for (std::uint64_t t = 0; t < 10; ++t) push(t);
  EXPECT_EQ(push(7), Verdict::old);
  EXPECT_EQ(push(9), Verdict::old);
  EXPECT_EQ(buffer.counters().old, 2u);
  EXPECT_EQ(buffer.counters().received, 10u);
  EXPECT_EQ(buffer.counters().lost, 0u);
}

TEST_F(Buffer, OneThatIsOvertakenInTimeIsPutInItsPlace) {
  for (std::uint64_t t : {0, 1, 2, 4, 5}) push(t);
  EXPECT_EQ(buffer.counters().lost, 1u);
  EXPECT_EQ(buffer.push(at_tick(3), on_time(5) + 10), Verdict::taken);
  EXPECT_EQ(buffer.counters().lost, 0u);
  EXPECT_EQ(buffer.counters().reordered, 1u);
  EXPECT_NEAR(ball_x(on_time(5)), kSpeed * 0.0035, 2e-6);
}

TEST_F(Buffer, OneFromLongAgoIsOld) {
  for (std::uint64_t t = 1000; t < 1200; ++t) push(t);
  EXPECT_EQ(push(1), Verdict::old);
  EXPECT_EQ(buffer.counters().old, 1u);
}

TEST_F(Buffer, LossIsCountedAndBridged) {
  for (std::uint64_t t = 0; t < 300; ++t) {
    if (t < 290 || t > 295) push(t);
  }
  EXPECT_EQ(buffer.counters().lost, 6u);
  EXPECT_NEAR(ball_x(on_time(299) - 5000), kSpeed * (0.294 - 0.0015), 1e-5);
}

TEST_F(Buffer, AnotherSessionsSnapshotsAreForeignUntilItIsJoined) {
  push(100);
  wire::Snapshot other = at_tick(3);
  other.session = 78;
  EXPECT_EQ(buffer.push(other, on_time(101)), Verdict::foreign);
  EXPECT_EQ(buffer.counters().foreign, 1u);
  buffer.begin_session(78, 1000);
  EXPECT_FALSE(buffer.sample(on_time(101)).any);
  EXPECT_EQ(buffer.push(other, on_time(102)), Verdict::taken);
  EXPECT_EQ(buffer.sample(on_time(102)).state.tick, 3u);
  EXPECT_EQ(push(101), Verdict::foreign);
}

TEST_F(Buffer, ASessionThatGoesOnKeepsItsScene) {
  for (std::uint64_t t = 0; t < 50; ++t) push(t);
  buffer.begin_session(kSession, 1000);
  EXPECT_TRUE(buffer.sample(on_time(50)).any);
}

TEST_F(Buffer, ASessionThatGoesOnAfterALossIsSeenAtOnceAndItsOldSnapshotsAreStillOld) {
  for (std::uint64_t t = 0; t < 5000; ++t) push(t);
  buffer.begin_session(kSession, 1000);
  EXPECT_EQ(push(5600), Verdict::taken) << "0.6 s later: no jump";
  EXPECT_EQ(push(4500), Verdict::old);
  EXPECT_EQ(buffer.counters().implausible, 0u);
  EXPECT_EQ(buffer.counters().lost, 0u) << "what was sent while nobody listened is not lost";
  wire::Snapshot forged = at_tick(5601);
  forged.sequence = ~std::uint64_t{0};
  EXPECT_EQ(buffer.push(forged, on_time(5601)), Verdict::implausible);
}

TEST_F(Buffer, DelayGrowsWithJitterAndMotionStaysEven) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> late(0, 4000);
  float last = -1;
  double worst = 0;
  std::int64_t last_now = 0;
  // Arrivals are processed in order of time; a frame is drawn each 7 ms.
  std::vector<std::pair<std::int64_t, std::uint64_t>> arrivals;
  for (std::uint64_t t = 0; t < 4000; ++t) arrivals.emplace_back(on_time(t) + late(random), t);
  std::sort(arrivals.begin(), arrivals.end());
  std::int64_t next_frame = on_time(1000);
  for (const auto& [arrival, tick] : arrivals) {
    for (; next_frame < arrival; next_frame += 7000) {
      const float x = ball_x(next_frame);
      if (last >= 0)
        worst = std::max(worst, std::abs((static_cast<double>(x - last)) /
                                             (1e-6 * static_cast<double>(next_frame - last_now)) -
                                         kSpeed));
      last = x;
      last_now = next_frame;
    }
    buffer.push(at_tick(tick), arrival);
  }
  EXPECT_GT(buffer.delay_us(), 4500);  // 1.5 ms and most of the 4 ms of jitter
  EXPECT_LE(buffer.delay_us(), 5600);
  EXPECT_LT(worst, 0.09 * kSpeed);  // the slew: at most one part in 12
  EXPECT_EQ(buffer.counters().lost, 0u);
}

TEST_F(Buffer, StarvingGoesOnBrieflyThenStandsStillAndSaysSo) {
  for (std::uint64_t t = 0; t < 300; ++t) push(t);
  const std::int64_t end = on_time(299) + buffer.delay_us();  // when the newest is shown
  const SceneSample brief = buffer.sample(end + 10'000);
  EXPECT_FALSE(brief.starving);
  EXPECT_NEAR(brief.state.ball.position[0], kSpeed * 0.309, 1e-5);
  const SceneSample stopped = buffer.sample(end + 60'000);
  EXPECT_TRUE(stopped.starving);
  EXPECT_NEAR(stopped.state.ball.position[0], kSpeed * 0.319, 1e-5);  // 20 ms ahead, no further
  EXPECT_EQ(buffer.sample(end + 400'000).state.ball.position[0], stopped.state.ball.position[0]);
}

TEST_F(Buffer, PlayGoesOnInTimeAfterAStallOfTheServer) {
  for (std::uint64_t t = 0; t < 300; ++t) push(t);
  // The server stood still for 2 s and continues with the next tick.
  for (std::uint64_t t = 300; t < 320; ++t) buffer.push(at_tick(t), on_time(t) + 2'000'000);
  const SceneSample sample = buffer.sample(on_time(319) + 2'000'000);
  EXPECT_FALSE(sample.starving);
  EXPECT_NEAR(sample.state.ball.position[0], kSpeed * 0.3175, 1e-4);
}

TEST_F(Buffer, APauseThatStopsTheTickIsNoStarving) {
  for (std::uint64_t t = 0; t < 100; ++t) push(t);
  for (std::uint64_t i = 1; i < 500; ++i) {
    wire::Snapshot standing = at_tick(99);
    standing.sequence = 100 + i;
    standing.paused = true;
    EXPECT_EQ(buffer.push(standing, on_time(99 + i)), Verdict::taken);
  }
  const SceneSample sample = buffer.sample(on_time(598));
  EXPECT_TRUE(sample.state.paused);
  EXPECT_FALSE(sample.starving);
  EXPECT_EQ(buffer.counters().lost, 0u);
}

// The largest values that the decoders accept: computed in 64 bits, checked by the sanitizer.
TEST_F(Buffer, TheLastTickOfTheLongestTicksIsShownAndLeftAgain) {
  buffer.begin_session(kSession + 1, wire::kMaxTickUs);
  wire::Snapshot s = at_tick(wire::kMaxTick);
  s.session = kSession + 1;
  ASSERT_EQ(buffer.push(s, kStart), Verdict::taken);
  EXPECT_EQ(buffer.sample(kStart + 1000).state.tick, wire::kMaxTick);
  s.tick = 0;
  ASSERT_EQ(buffer.push(s, kStart + 2000), Verdict::taken);
  EXPECT_TRUE(buffer.sample(kStart + 3000).any);
  buffer.take_events();
}

TEST_F(Buffer, AnEventRepeatedInManySnapshotsIsGivenOnceWhenItsTickIsShown) {
  std::vector<wire::EventSnapshot> seen;
  for (std::uint64_t t = 0; t < 40; ++t) {
    wire::Snapshot s = at_tick(t);
    if (t >= 20 && t < 28) s.events.push_back(event(5));
    if (t >= 22 && t < 30) s.events.push_back(event(6));
    buffer.push(s, on_time(t));
    buffer.sample(on_time(t));
    const auto events = buffer.take_events();
    if (t < 22 || t > 26) {
      EXPECT_TRUE(events.empty()) << t;
    }
    seen.insert(seen.end(), events.begin(), events.end());
  }
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].id, 5u);
  EXPECT_EQ(seen[1].id, 6u);
}

// If accepted, one of these made everything after it too old permanently.
TEST_F(Buffer, AJumpOfTickOrSequenceIsNotBelievedAndStopsNothing) {
  for (std::uint64_t t = 0; t < 100; ++t) push(t);
  wire::Snapshot far_tick = at_tick(100), far_sequence = at_tick(100);
  far_tick.tick = wire::kMaxTick;
  far_sequence.sequence = ~std::uint64_t{0};
  for (wire::Snapshot forged : {far_tick, far_sequence}) {
    forged.events = {event(0x7FFFFFFF)};
    EXPECT_EQ(buffer.push(forged, on_time(99) + 500), Verdict::implausible);
  }
  for (std::uint64_t t = 100; t < 200; ++t) EXPECT_EQ(push(t), Verdict::taken);
  EXPECT_NEAR(ball_x(on_time(199)), kSpeed * (0.199 - 0.0015), 2e-6);
  EXPECT_TRUE(buffer.take_events().empty());
  EXPECT_EQ(buffer.counters().implausible, 2u);
  EXPECT_EQ(buffer.counters().lost, 0u);
}

TEST_F(Buffer, AServerThatItselfJumpsIsFollowedAfterAMoment) {
  for (std::uint64_t t = 50'000; t < 50'100; ++t) push(t);
  int refused = 0;
  for (std::uint64_t t = 0; t < 100; ++t) {  // back, as after another match was restored
    wire::Snapshot s = at_tick(t);
    s.sequence = 50'101 + t;
    refused += buffer.push(s, on_time(50'100 + t)) != Verdict::taken;
  }
  EXPECT_EQ(refused, SnapshotBuffer::kAgreeing - 1);
  EXPECT_EQ(buffer.sample(on_time(50'200)).state.tick, 98u);
}

TEST_F(Buffer, AStallIsNoJump) {
  for (std::uint64_t t = 0; t < 100; ++t) push(t);
  for (std::uint64_t t = 5100; t < 5200; ++t) EXPECT_EQ(push(t), Verdict::taken) << t;
}

}  // namespace
}  // namespace client
