// From input to picture in software, with a scripted server and a scripted clock.
#include "client/rod_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <deque>

#include "client/snapshot_buffer.h"
#include "scripted_scene.h"
#include "wire/enums.h"

namespace client {
namespace {

constexpr int kRod = 3;  // midfield of team 0
constexpr std::int64_t kMs = 1000;
using Hand = std::array<wire::InputRod, 8>;

// A server whose rods follow foosball/rod_motion.h; inputs and snapshots have a transit time.
// Frames of a window are drawn from a SnapshotBuffer with and without prediction.
class HandToPicture {
 public:
  HandToPicture(std::int64_t way_us, std::int64_t frame_us) : way_us_(way_us), frame_us_(frame_us) {
    buffer_.begin_session(1, 1000);
    for (auto& rod : state_.rods) rod = {0, 0, 0, 0, 1, 2};
    place_men(state_);
    for (int i = 0; i < 20; ++i) frame(hand_);
  }

  // Draws one frame with this input.
  void frame(const Hand& hand) {
    hand_ = hand;
    for (std::int64_t to = now_us_ + frame_us_; now_us_ < to; now_us_ += kMs) server_tick();
    inputs_.push_back({now_us_ + way_us_, hand});
    SceneSample sample = buffer_.sample(now_us_);
    seen_ = sample.state;
    drawn_ = sample.state;
    prediction_.update(hand, seen_, now_us_);
    prediction_.apply(drawn_);
  }
  float seen() const { return seen_.rods[kRod].slide; }
  float drawn() const { return drawn_.rods[kRod].slide; }
  const wire::Snapshot& scene() const { return drawn_; }
  std::int64_t now() const { return now_us_; }
  const RodPrediction& prediction() const { return prediction_; }
  double blocked_at = 1.0;  // [m]

  static Hand at(float slide) {
    Hand hand{};
    for (const int rod : {0, 1, 3, 5}) hand[static_cast<std::size_t>(rod)].driven = true;
    hand[kRod].slide = slide;
    return hand;
  }

 private:
  struct Sent {
    std::int64_t arrives;
    Hand hand;
  };
  void server_tick() {
    while (!inputs_.empty() && inputs_.front().arrives <= now_us_) {
      applied_ = inputs_.front().hand;
      inputs_.pop_front();
    }
    const auto& table = foosball::table_spec(foosball::Layout::tournament);
    const wire::InputRod& in = applied_[kRod];
    rod_ = foosball::step_rod(
        table.rods[kRod],
        foosball::rod_inertia(table, table.rods[kRod], foosball::built_in_characters()[0].body),
        rod_, {in.slide, in.angle, 0, 0, true});
    if (rod_.slide > blocked_at) rod_ = {blocked_at, rod_.angle, 0.0, rod_.angle_rate};
    state_.tick = state_.sequence = static_cast<std::uint64_t>(now_us_ / kMs) + 1;
    state_.rods[kRod].slide = static_cast<float>(rod_.slide);
    state_.rods[kRod].slide_rate = static_cast<float>(rod_.slide_rate);
    place_men(state_);
    under_way_.push_back({now_us_ + way_us_, state_});
    while (!under_way_.empty() && under_way_.front().first <= now_us_) {
      buffer_.push(under_way_.front().second, under_way_.front().first);
      under_way_.pop_front();
    }
  }

  std::int64_t way_us_, frame_us_, now_us_ = 1'000'000;
  Hand hand_ = at(0.0f), applied_ = at(0.0f);
  foosball::RodState rod_{};
  wire::Snapshot state_ = scripted_play(0.0), seen_, drawn_;
  std::deque<Sent> inputs_;
  std::deque<std::pair<std::int64_t, wire::Snapshot>> under_way_;
  SnapshotBuffer buffer_;
  RodPrediction prediction_{foosball::Layout::tournament};
};

struct Latency {
  int seen_ms = -1, drawn_ms = -1;  // until the rod has moved half of its distance
};

Latency latency(std::int64_t way_us, std::int64_t frame_us) {
  HandToPicture play(way_us, frame_us);
  Latency result;
  const std::int64_t moved_at = play.now() + frame_us;  // the window reads the input in this frame
  for (int i = 0; i < 100 && (result.seen_ms < 0 || result.drawn_ms < 0); ++i) {
    play.frame(HandToPicture::at(0.04f));
    const auto since = static_cast<int>((play.now() - moved_at) / kMs);
    if (result.seen_ms < 0 && play.seen() > 0.02f) result.seen_ms = since;
    if (result.drawn_ms < 0 && play.drawn() > 0.02f) result.drawn_ms = since;
  }
  std::printf("way %lld ms, frame %lld ms: server's rod after %d ms, predicted after %d ms\n",
              static_cast<long long>(way_us / kMs), static_cast<long long>(frame_us / kMs),
              result.seen_ms, result.drawn_ms);
  return result;
}

TEST(RodPrediction, TheOwnRodIsDrawnWithTheHandWhateverTheWayToTheServer) {
  for (const std::int64_t way : {0, 10, 60}) {
    for (const std::int64_t frame : {8, 16, 33, 100}) {
      const Latency of = latency(way * kMs, frame * kMs);
      // In the frame that read the input, if that frame is as long as the rod's own motion takes.
      EXPECT_LE(of.drawn_ms, 16) << way << " " << frame;
      EXPECT_GE(of.seen_ms, of.drawn_ms + 2 * way) << way << " " << frame;
    }
  }
}

TEST(RodPrediction, AMovingHandIsDrawnWithoutTrembling) {
  HandToPicture play(40 * kMs, 16 * kMs);
  double last = play.drawn(), roughest = 0.0;
  for (int i = 0; i < 200; ++i) {
    const float t = 0.016f * static_cast<float>(i);
    play.frame(HandToPicture::at(0.05f * std::sin(6.0f * t)));
    if (i > 60) {
      // The input's own step in a frame is at most 4.8 mm.
      roughest = std::max(roughest, std::fabs(play.drawn() - last));
      EXPECT_NEAR(play.drawn(), 0.05f * std::sin(6.0f * t), 0.003) << i;
    }
    last = play.drawn();
  }
  EXPECT_LT(roughest, 0.0062);
  // Two transit times, a frame, a tick, the interpolation.
  EXPECT_NEAR(play.prediction().lag_ms(), 98, 8);
}

TEST(RodPrediction, APinchedRodIsDrawnPinchedWithinAFewFrames) {
  HandToPicture play(5 * kMs, 16 * kMs);
  for (int i = 0; i < 60; ++i)  // to estimate the lag
    play.frame(HandToPicture::at(0.03f * std::sin(0.2f * static_cast<float>(i))));
  play.blocked_at = 0.010;
  int frames = 0;
  for (; frames < 60; ++frames) {
    play.frame(HandToPicture::at(0.05f));
    if (frames > 1 && play.drawn() < 0.010f + 0.004f) break;
  }
  std::printf("pinched: within 4 mm of the truth after %d frames\n", frames);
  EXPECT_LE(frames, 8);
  for (int i = 0; i < 30; ++i) play.frame(HandToPicture::at(0.05f));
  EXPECT_NEAR(play.drawn(), 0.010, 0.0005);
  // Released, it follows the input again.
  play.blocked_at = 1.0;
  for (int i = 0; i < 30; ++i) play.frame(HandToPicture::at(0.05f));
  EXPECT_NEAR(play.drawn(), 0.05, 0.0005);
}

TEST(RodPrediction, MenMoveWithTheirRodAndOthersStay) {
  HandToPicture play(10 * kMs, 16 * kMs);
  Hand hand = HandToPicture::at(0.03f);
  hand[kRod].angle = 0.5;
  play.frame(hand);
  const wire::Snapshot& scene = play.scene();
  wire::Snapshot expected = scene;
  place_men(expected);
  for (std::size_t i = 0; i < scene.men.size(); ++i) {
    EXPECT_NEAR(scene.men[i].body.position[1], expected.men[i].body.position[1], 1e-5);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(scene.men[i].body.orientation[k], expected.men[i].body.orientation[k], 1e-5);
    }
  }
}

// A hinged man blocked by the ball: the input shows at once, but he stays where the server has him.
TEST(RodPrediction, AManWhoIsHeldStaysWhereTheServerHasHim) {
  wire::Snapshot server = scripted_play(0.0, foosball::Layout::paper);
  for (auto& rod : server.rods) rod = {0, 0, 0, 0, 1, 2};
  place_men(server);
  const auto turned = [](float angle) {
    return std::array<float, 4>{0, std::sin(0.5f * angle), 0, std::cos(0.5f * angle)};
  };
  constexpr int kHeldMan = 2;
  for (wire::ManState& man : server.men) {
    if (man.rod == kRod && man.man == kHeldMan) man.body.orientation = turned(-0.6f);
  }
  RodPrediction prediction(foosball::Layout::paper);
  Hand hand = HandToPicture::at(0.02f);
  prediction.update(hand, server, 16 * kMs);
  hand[kRod].angle = 0.9f;
  for (int frame = 2; frame < 6; ++frame) prediction.update(hand, server, frame * 16 * kMs);
  wire::Snapshot drawn = server;
  prediction.apply(drawn);
  ASSERT_GT(drawn.rods[kRod].angle, 0.3f);
  int of_row = 0;
  for (const wire::ManState& man : drawn.men) {
    if (man.rod != kRod) continue;
    ++of_row;
    const auto expected = man.man == kHeldMan ? turned(-0.6f) : turned(drawn.rods[kRod].angle);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(man.body.orientation[k], expected[k], 1e-5) << int{man.man};
  }
  EXPECT_EQ(of_row, 4);
}

TEST(RodPrediction, RodsOfOthersAndOfAPausedMatchAreTheServers) {
  const Hand hand = HandToPicture::at(0.05f);
  wire::Snapshot scene = scripted_play(0.7);  // rods of team 0 move only as scripted
  for (auto& rod : scene.rods) rod.source = number(wire::RodSource::computer);
  wire::Snapshot paused = scripted_play(0.7);
  paused.paused = true;
  for (const wire::Snapshot* server : {&scene, &paused}) {
    RodPrediction prediction(foosball::Layout::tournament);
    wire::Snapshot drawn = *server;
    for (int i = 1; i < 10; ++i) prediction.update(hand, *server, i * 16 * kMs);
    prediction.apply(drawn);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(drawn.rods[i].slide, server->rods[i].slide);
  }
}

}  // namespace
}  // namespace client
