// Frame rate, and speed of the scene time relative to real time, over the last half second.
#pragma once

#include <cstdint>

namespace sandbox {

class Meter {
 public:
  // Call at the end of a frame. scene_time: since the scene's start [s]; restarts after a reset.
  void frame(std::int64_t now_ns, double scene_time);
  int frames() const { return frames_; }
  double rate() const { return rate_; }    // [1/s]
  double speed() const { return speed_; }  // relative to real time

 private:
  static constexpr std::int64_t kWindowNs = 500'000'000;
  std::int64_t since_ns_ = 0;
  double since_time_ = 0.0, rate_ = 0.0, speed_ = 0.0;
  int frames_ = 0, window_frames_ = 0;
};

}  // namespace sandbox
