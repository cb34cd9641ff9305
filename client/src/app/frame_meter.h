// Counts frames, and detects a quality that is too slow for the machine.
#pragma once

#include <cstdint>

namespace client {

class FrameMeter {
 public:
  // Slower than this is not playable; a machine that draws high quality more slowly should use low.
  static constexpr double kTooSlowS = 1.0 / 30.0;

  void begin(std::int64_t now_us);  // before a frame is drawn
  void end(std::int64_t now_us);    // after it was shown
  std::uint64_t frames() const { return frames_; }
  double rate() const { return rate_; }  // over about the last half second [1/s]
  // After each 20 frames: whether they were too slow on average. The first few frames, in which
  // resources load, do not count.
  bool too_slow() const { return too_slow_; }
  void restart_judgement();

 private:
  std::uint64_t frames_ = 0;
  std::int64_t began_us_ = 0, rate_since_us_ = 0;
  std::uint64_t rate_frames_ = 0;
  double rate_ = 0.0, spent_s_ = 0.0;
  int judged_ = 0, skip_ = 5;
  bool too_slow_ = false;
};

}  // namespace client
