// Playback of one recording: the moment, the speed, pauses, goals. No window, no drawing.
#pragma once

#include <memory>
#include <string>

#include "commands.h"
#include "timeline.h"

namespace watch {

class Player {
 public:
  static constexpr std::array<double, 6> kSpeeds{0.125, 0.25, 0.5, 1.0, 2.0, 4.0};
  static constexpr int kNormal = 3;               // index in kSpeeds
  static constexpr double kBeforeGoal = 2'000.0;  // lead-in before a goal [ticks]

  explicit Player(std::unique_ptr<Timeline> timeline) : timeline_(std::move(timeline)) {}

  // Handles commands of playback; false for any other.
  bool act(Command command);
  // The person drags the position to this moment [s]; drop() ends the drag.
  void drag(double seconds);
  void drop() { dragging_ = false; }
  bool dragging() const { return dragging_; }
  void go_to(double tick);
  // Advances by dt [s] of the clock. Events accumulate in the scene.
  void advance(double dt);

  double speed() const { return kSpeeds[static_cast<std::size_t>(speed_)]; }
  bool paused() const { return paused_; }
  bool stands() const { return paused_ || dragging_; }
  double tick() const { return tick_; }
  Timeline& timeline() { return *timeline_; }
  const Timeline& timeline() const { return *timeline_; }
  // A message in English, returned once; empty: none.
  std::string take_message() { return std::exchange(message_, {}); }
  // A jump has changed the moment since the last call.
  bool take_jump() { return std::exchange(jumped_, false); }

 private:
  void step(double ticks);
  void go_to_goal(int direction);

  std::unique_ptr<Timeline> timeline_;
  double tick_ = 0.0;
  int speed_ = kNormal;
  bool paused_ = false, dragging_ = false, jumped_ = false;
  std::string message_;
};

}  // namespace watch
