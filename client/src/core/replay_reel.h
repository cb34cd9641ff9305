// Replays the last moments of play before a goal, as they were drawn, in slow motion.
#pragma once

#include <cstdint>
#include <deque>

#include "wire/snapshot.h"

namespace client {

class ReplayReel {
 public:
  static constexpr std::int64_t kKeptUs = 2'000'000;
  static constexpr std::int64_t kWaitUs = 350'000;    // the replay begins this time after the goal
  static constexpr std::int64_t kBeforeUs = 750'000;  // it shows from this time before the goal
  static constexpr std::int64_t kAfterUs = 200'000;   // ... to this time after it
  static constexpr double kSpeed = 0.3;               // of the replay; 1 is real time

  // drawn: the scene to be drawn at now_us. Records it during play. During the ceremony of a goal,
  // replaces its bodies by the replay's while the replay runs. Returns whether it did.
  bool follow(wire::Snapshot& drawn, std::int64_t now_us);
  // Records a scene of play, drawn at now_us. Drops scenes older than kKeptUs.
  void record(const wire::Snapshot& scene, std::int64_t now_us);
  void mark_goal(std::int64_t now_us);
  void skip() { skipped_ = true; }
  void clear();
  // The goal's replay is running: from kWaitUs after the goal until its end or skip().
  bool showing(std::int64_t now_us) const;
  // The replay's scene at now_us. Precondition: showing(now_us).
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
