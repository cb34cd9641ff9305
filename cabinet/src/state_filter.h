// Estimates the pose and rates of a rod at any time, from increments that arrive in reports, which
// arrive in frames.
//
// Report k gives the rod's pose at its time t_k. Frames only show that the report came after one
// frame and before the next. Reports are periodic, t_(k+1) = t_k + T: each frame with counts bounds
// t_k, and the estimates of t_(k-1) and T bound it further. So t_k is known to a fraction of a
// frame, and T with it (a phase-locked loop whose phase detector is a pair of bounds).
//
// After a report, the position is extrapolated as
//   p(t) = p_k + v s + a s^2 / 2,   s = t - t_k
// Here v is the slope of the longest line through the last reports from which no report deviates by
// more than its noise (first-order adaptive windowing: Janabi-Sharifi, Hayward and Chen,
// "Discrete-time adaptive windowing for velocity estimation", 2000), and a = 0. If not even three
// reports lie on a line, v and a are those of the parabola through the last three. A braking hand
// does not reverse: the motion ends where v + a s = 0. If a report was due and did not come, the
// rod rests at the last report.
//
// docs/decisions/0056-state-at-the-tick.md gives the resulting accuracy.
#pragma once

#include <array>
#include <cstdint>

#include "cabinet/calibration.h"

namespace cabinet {

struct RodAhead {
  double slide = 0, angle = 0;            // since the last report [m], [rad]
  double slide_rate = 0, angle_rate = 0;  // [m/s], [rad/s]
};

// The resolution of a sensor with this calibration.
RodMotion count_of(const RodCalibration& calibration);

class StateFilter {
 public:
  // count: resolution of the sensor [m], [rad]. stamped: frames with counts carry the reports' own
  // times; otherwise any time.
  explicit StateFilter(RodMotion count, bool stamped = false)
      : count_{count.slide, count.angle}, stamped_(stamped), period_us_(stamped ? 8'000 : 5'000) {}

  // Adds a frame: its time on the device's clock [us], non-decreasing, and the motion since the
  // previous frame.
  void update(double d_slide, double d_angle, std::int64_t frame_us);
  // State at this time of the device's clock. A time before the last frame counts as that of the
  // frame.
  RodAhead at(std::int64_t time_us) const;
  void rest();  // the rod is at rest; the next increment starts a motion

  double report_us() const { return period_us_; }  // T, as estimated

 private:
  static constexpr int kReports = 8;  // history length
  struct Report {
    double time_us = 0;
    std::array<double, 2> position{};  // since the motion started
  };
  struct Line {
    double rate = 0, acceleration = 0;  // at the last report
  };
  struct Bounds {
    double after_us = 0, until_us = 0;
    double middle() const { return 0.5 * (after_us + until_us); }
  };
  bool synchronous() const;
  void locate(const Bounds& frames, bool fast);
  void learn_period(double until_us, bool fast);
  void append(double time_us, const std::array<double, 2>& step);
  const Report& report(int back) const { return reports_[(newest_ - back + kReports) % kReports]; }
  Report& report(int back) { return reports_[(newest_ - back + kReports) % kReports]; }
  int steady_reports(int axis) const;
  Line line(int axis) const;
  bool due(double frame_us) const;

  std::array<double, 2> count_;
  bool stamped_;
  double period_us_;                           // initially that of a USB mouse, or of a PS/2 mouse
  double frame_us_ = 0, interval_us_ = 1'000;  // last frame; time between frames
  double seen_us_ = 0;                         // frame of the last report
  Bounds bounds_;                              // of the time of the last report
  bool started_ = false, located_ = false, moving_ = false;
  std::array<Report, kReports> reports_{};
  int newest_ = 0, known_ = 0;
  std::array<Line, 2> lines_{};
  int run_ = 0;  // consecutive fast reports, and the frame of the first
  double run_began_us_ = 0;
};

}  // namespace cabinet
