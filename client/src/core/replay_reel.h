// The last moments of play before a goal as they were drawn, shown again in slow motion.
#pragma once

#include <cstdint>
#include <deque>

#include "wire/snapshot.h"

namespace client {

class ReplayReel {
 public:
  static constexpr std::int64_t kKeptUs = 2'000'000;
  static constexpr std::int64_t kWaitUs = 350'000;    // after the goal the replay begins
  static constexpr std::int64_t kBeforeUs = 750'000;  // shown from so long before the goal
  static constexpr std::int64_t kAfterUs = 200'000;   // ... to so long after it
  static constexpr double kSpeed = 0.3;               // of the replay, real time is 1

  // The scene that is to be drawn at now: remembered while there is play, and while the ceremony of
  // a goal lasts made into what is shown again. Whether it was.
  bool follow(wire::Snapshot& drawn, std::int64_t now_us);
  // A scene of play, drawn at now. Those older than kKeptUs are forgotten.
  void record(const wire::Snapshot& scene, std::int64_t now_us);
  void mark_goal(std::int64_t now_us);
  void skip() { skipped_ = true; }
  void clear();
  // The goal's replay runs: from kWaitUs after the goal, until all was shown or it was skipped.
  bool showing(std::int64_t now_us) const;
  // The scene of the replay at now. Precondition: showing(now).
  wire::Snapshot scene(std::int64_t now_us) const;

 private:
  struct Frame {
    std::int64_t at_us;
    wire::Snapshot scene;
  };
  std::int64_t shown_us(std::int64_t now_us) const;

  std::deque<Frame> frames_;
  std::int64_t goal_us_ = 0;
  bool goal_ = false, skipped_ = false;
  std::uint8_t screen_before_ = 0;
};

}  // namespace client
