// Converts the input of one person at a window to RodInputs: a mouse (slide and spin of the active
// rod), keys and the wheel (choice of rod), or a gamepad. It does not depend on a window: the
// caller passes events in.
//
// All rods of the person are live. The input moves only the active rod; the others stay where they
// were left.
// - Mouse: relative, both axes are positions.
// - Keys: slide by a rate that ramps up. Spin is a flick: the backward key cocks the feet, the
//   forward key shoots, and releasing returns the men to straight down.
// - Gamepad: the left stick sets the slide rate (with position control, the rod would return with
//   the released stick). The right stick's vertical axis is the angle, so that pulling back and
//   snapping forward is a shot.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "cabinet/rate_filter.h"
#include "cabinet/rod_input.h"

namespace cabinet {

constexpr float kStickDeadZone = 0.12f;  // fraction of full deflection, for a worn stick

// Slide of a key that is pressed and released between two polls [m]: that of a held key, on its
// ramp, for a person's shortest tap, 30 ms.
inline constexpr double kTapSlide = 0.0054;
// Angle of a full flick by key or stick, in either direction [rad]. The men hit the ball at 0.
inline constexpr double kSwing = 1.4;

struct HandOptions {
  std::array<int, 4> rods{0, 1, 3, 5};  // of this person's team, from the own goal outwards
  std::array<bool, 4> has{true, true, true, true};  // which of them the person plays
  std::array<double, 4> slide_limit{};              // |slide| <= this [m]
  double slide_sign = 1.0;  // mouse to the right / stick up: +slide times this
  double angle_sign = 1.0;  // mouse forward swings the feet forward
  double metres_per_pixel = 0.0006;
  double radians_per_pixel = 0.012;
};

// State of a gamepad's two sticks and shoulder buttons. Axes -1..1, right and up positive (GLFW and
// Linux report up as negative: the caller inverts it). Either axis of the left stick slides; the
// larger one applies. right_x has no effect.
struct PadState {
  float left_x = 0, left_y = 0, right_x = 0, right_y = 0;
  bool previous_rod = false, next_rod = false;  // shoulder buttons, pressed or not
};

class Hand final : public InputSource {
 public:
  explicit Hand(const HandOptions& options);

  void mouse_moved(double right_px, double forward_px);
  void choose(int line);  // 0..3 from the own goal outwards; ignores others and those not played
  void cycle(int steps);  // wheel: +1 is the next one outwards; does not wrap at either end
  void key_axis(double slide, double spin);  // held keys, each -1, 0, 1
  // Signed counts of keys that were pressed and released between two polls. Each slide tap moves
  // the rod by kTapSlide. Any spin tap swings the feet to kSwing for one poll.
  void key_taps(int slide, int spin);
  void pad(const PadState& state);
  // Sets the true pose of a rod (call it with each snapshot). It applies only until this hand first
  // moves the rod, so that nothing jumps; then the rod follows the hand, and later calls are
  // ignored. release() makes calls apply again.
  void adopt(int rod, double slide, double angle);
  void release();
  // Something else has moved a rod of this hand: continue from this pose.
  void place(int rod, double slide, double angle);
  // Keys or a stick hold a swing, or the active rod turns as fast as in a shot.
  bool strikes() const;

  int active_line() const;  // 0..3
  int active_rod() const;   // index of the rod on the table

  void poll(std::int64_t now_us) override;
  const RodInputs& rods() const override;
  const SourceCounters& counters() const override;  // frames: polls
  const std::string& name() const override;

 private:
  struct Line {
    double slide = 0, angle = 0;            // target pose
    double sent_slide = 0, sent_angle = 0;  // at the last poll
    bool moved = false;                     // this hand has moved it: adopt() is ignored
    bool swinging = false;  // keys or the stick control the angle, or it returns from that
    double rest_angle = 0;  // angle at which the men hang straight down
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
