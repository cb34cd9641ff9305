// One person at a window: a mouse (slide and spin of the active rod), keys and the wheel (choice of
// rod), or a gamepad, turned into RodInputs. It knows no window: events are handed in.
//
// All rods of the person are live; only the active one moves by the hand's motion, the others stay
// where the hand left them.
// - Mouse: relative, both axes positions.
// - Keys: slide by a rate that ramps up; spin is a flick: held back it cocks the feet, held forward
//   it strikes, let go it hangs the men straight down again.
// - Gamepad: left stick slides by rate (position would let go of the rod with the stick); right
//   stick up and down is the angle itself, so that pulling back and snapping forward is a shot.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "cabinet/rate_filter.h"
#include "cabinet/rod_input.h"

namespace cabinet {

constexpr float kStickDeadZone = 0.12f;  // of a worn stick, of its full way

// What a key does that is let go before the hand is polled: as if held for a person's shortest tap,
// 30 ms, of the ramp that held keys have [m].
inline constexpr double kTapSlide = 0.0054;
// Of a full flick by key or stick, either way [rad]: the ball is struck at 0.
inline constexpr double kSwing = 1.4;

struct HandOptions {
  std::array<int, 4> rods{0, 1, 3, 5};              // of this person's team, own goal outwards
  std::array<bool, 4> has{true, true, true, true};  // those of them that the person plays
  std::array<double, 4> slide_limit{};              // |slide| <= this [m]
  double slide_sign = 1.0;  // mouse to the right / stick up: +slide times this
  double angle_sign = 1.0;  // mouse forward swings the feet forward
  double metres_per_pixel = 0.0006;
  double radians_per_pixel = 0.012;
};

// State of a gamepad's two sticks and shoulder buttons. Axes -1..1, right and up positive (GLFW and
// Linux give up as negative: turn it round). Either axis of the left stick slides, the larger wins.
// right_x does nothing.
struct PadState {
  float left_x = 0, left_y = 0, right_x = 0, right_y = 0;
  bool previous_rod = false, next_rod = false;  // shoulder buttons, as held
};

class Hand final : public InputSource {
 public:
  explicit Hand(const HandOptions& options);

  void mouse_moved(double right_px, double forward_px);
  void choose(int line);  // 0..3, own goal outwards; others, and those it has not, are ignored
  void cycle(int steps);  // wheel: +1 outwards among those it has, wraps at neither end
  void key_axis(double slide, double spin);  // held keys, each -1, 0, 1
  // Keys that were pressed and let go between two polls, how often, with their sign: each moves the
  // rod by kTapSlide; any spin swings the feet to kSwing for one poll.
  void key_taps(int slide, int spin);
  void pad(const PadState& state);
  // Where the rods really are (from the snapshot; call it with each): taken over once, until this
  // hand first moves the rod, so that nothing jumps. Later calls are ignored: the rod then follows
  // the hand, not the hand the rod. release() makes the next ones count again.
  void adopt(int rod, double slide, double angle);
  void release();
  // Something else has moved a rod of this hand: it goes on from there.
  void place(int rod, double slide, double angle);
  // Keys or a stick hold a swing, or the active rod turns as a strike does.
  bool strikes() const;

  int active_line() const;  // 0..3
  int active_rod() const;   // index of the rod on the table

  void poll(std::int64_t now_us) override;
  const RodInputs& rods() const override;
  const SourceCounters& counters() const override;  // frames: polls
  const std::string& name() const override;

 private:
  struct Line {
    double slide = 0, angle = 0;            // where the hand wants it
    double sent_slide = 0, sent_angle = 0;  // at the last poll
    bool moved = false;                     // by this hand: adopt() is over
    bool swinging = false;  // keys or the stick hold the angle, or it returns from that
    double rest_angle = 0;  // the turn at which the men hang straight down
    RateFilter rate;
  };
  void slide_by(Line& line, double metres, double limit);
  void drive_slide(double seconds);
  void drive_swing(int line, double seconds);
  double swing_wanted() const;

  HandOptions options_;
  std::array<Line, 4> lines_;
  RodInputs rods_{};
  SourceCounters counters_;
  std::string name_ = "hand";
  int line_ = 2;
  double key_slide_ = 0, key_spin_ = 0;
  int slide_taps_ = 0, spin_taps_ = 0;
  double key_rate_ = 0;  // of the ramp [m/s]
  PadState pad_{};
  std::int64_t last_us_ = 0;
  bool started_ = false;
};

}  // namespace cabinet
