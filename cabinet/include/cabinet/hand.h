// One person at a window: a mouse (slide and spin of the active rod), keys and the wheel (choice of
// rod), or a gamepad, turned into RodInputs. It knows no window: events are handed in.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "cabinet/rod_input.h"

namespace cabinet {

struct HandOptions {
  std::array<int, 4> rods{0, 1, 3, 5};        // this person's rods, own goal outwards
  std::array<double, 4> slide_limit{};        // |slide| <= this [m]
  double slide_sign = 1.0;                    // mouse to the right / stick up: +slide times this
  double angle_sign = 1.0;                    // mouse forward swings the feet forward
  double metres_per_pixel = 0.0006;
  double radians_per_pixel = 0.012;
};

// State of a gamepad's two sticks and triggers, each -1..1.
struct PadState {
  float left_x = 0, left_y = 0, right_x = 0, right_y = 0;
  bool previous_rod = false, next_rod = false;  // shoulder buttons, as held
};

class Hand final : public InputSource {
 public:
  explicit Hand(const HandOptions& options);

  void mouse_moved(double right_px, double forward_px);
  void choose(int line);    // 0..3, own goal outwards; others are ignored
  void cycle(int steps);    // wheel: +1 outwards, wraps at neither end
  void key_axis(double slide, double spin);  // held keys, each -1, 0, 1
  void pad(const PadState& state);
  // Where the rods really are (from the snapshot): taken over when this hand takes a rod, so that
  // nothing jumps.
  void adopt(int rod, double slide, double angle);
  // Nearest rod to the ball becomes the active one while automatic choice is on.
  void set_automatic(bool on);
  void ball_at(double x, const std::array<double, 8>& rod_x);

  int active_line() const;  // 0..3
  int active_rod() const;   // index of the rod on the table

  void poll(std::int64_t now_us) override;
  const RodInputs& rods() const override;
  const SourceCounters& counters() const override;
  const std::string& name() const override;

 private:
  HandOptions options_;
  RodInputs rods_{};
  SourceCounters counters_;
  std::string name_ = "hand";
  int line_ = 2;
  bool automatic_ = false;
  double key_slide_ = 0, key_spin_ = 0;
  PadState pad_{};
  std::array<double, kRods> last_slide_{}, last_angle_{};
  std::int64_t last_us_ = 0;
  bool started_ = false;
};

}  // namespace cabinet
