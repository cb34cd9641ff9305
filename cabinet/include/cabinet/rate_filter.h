// Estimates rates from increments that arrive in bursts.
//
// A PS/2 mouse reports every 5 ms, and a frame is sent every 1 or 4 ms: most frames have no counts,
// one has those of 5 ms. So the filter takes rates between increments, not between frames:
//   instant = increment / (time since the last increment),   rate += kGain (instant - rate)
// The rate holds until the next increment, or becomes zero after hold_us without one. Measured on a
// steady motion through 4 ms frames: within 23 % of the true rate; exact through 1 ms frames
// (cabinet/tests/rod_tracker_test.cpp).
#pragma once

#include <cstdint>

namespace cabinet {

class RateFilter {
 public:
  // report_us: time spanned by one report, used for the first increment after rest.
  RateFilter(std::int64_t report_us, std::int64_t hold_us)
      : report_us_(report_us), hold_us_(hold_us) {}

  // time_us: on the device's own clock, non-decreasing.
  void update(double d_slide, double d_angle, std::int64_t time_us);
  void rest();  // sets rates to zero; the next increment counts as the first

  double slide_rate() const { return slide_rate_; }  // [m/s]
  double angle_rate() const { return angle_rate_; }  // [rad/s]

 private:
  std::int64_t report_us_, hold_us_;
  std::int64_t moved_us_ = 0, updated_us_ = 0;
  bool moving_ = false, started_ = false;
  double slide_rate_ = 0, angle_rate_ = 0;
};

}  // namespace cabinet
