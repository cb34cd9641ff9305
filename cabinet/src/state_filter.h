// Where a rod is, and how fast, at any time: from increments that come in reports, seen in frames.
//
// A report k says where the rod was at its time t_k; frames say only that it came after one frame
// and before the next. Reports are periodic, t_(k+1) = t_k + T: each frame that brings counts
// bounds t_k, and what is known of t_(k-1) and T bounds it further. So t_k is known to a fraction
// of a frame, and T with it (a phase-locked loop whose phase detector is a pair of bounds).
//
// After a report the position goes on by
//   p(t) = p_k + v s + a s^2 / 2,   s = t - t_k
// where v is the slope of the longest line through the last reports that no report leaves by more
// than its noise (first-order adaptive windowing: Janabi-Sharifi, Hayward and Chen, "Discrete-time
// adaptive windowing for velocity estimation", 2000), and a = 0; or, where not even three reports
// lie on a line, v and a are those of the parabola through the last three. A hand that brakes does
// not turn round: the motion ends where v + a s = 0. When a report was due and brought nothing, the
// rod stands where the last one said.
//
// docs/decisions/0056-state-at-the-tick.md has what this comes to.
#pragma once

#include <array>
#include <cstdint>

#include "cabinet/calibration.h"

namespace cabinet {

struct RodAhead {
  double slide = 0, angle = 0;            // beyond the last report [m], [rad]
  double slide_rate = 0, angle_rate = 0;  // [m/s], [rad/s]
};

// What a sensor of this calibration does not tell apart.
RodMotion count_of(const RodCalibration& calibration);

class StateFilter {
 public:
  // count: of the sensor [m], [rad], what is not told apart. stamped: frames with counts come at
  // the reports' own times, others at any.
  explicit StateFilter(RodMotion count, bool stamped = false)
      : count_{count.slide, count.angle}, stamped_(stamped), period_us_(stamped ? 8'000 : 5'000) {}

  // A frame, of the device's clock [us], which does not fall; what the sensor moved since the one
  // before.
  void update(double d_slide, double d_angle, std::int64_t frame_us);
  // At the time of the device's clock; before the last frame as if at it.
  RodAhead at(std::int64_t time_us) const;
  void rest();  // the rod stands; the next increment is the first of a motion

  double report_us() const { return period_us_; }  // T, as learned

 private:
  static constexpr int kReports = 8;  // remembered
  struct Report {
    double time_us = 0;
    std::array<double, 2> position{};  // since the motion began
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
  int steady_reports(int axis) const;
  Line line(int axis) const;
  bool due(double frame_us) const;

  std::array<double, 2> count_;
  bool stamped_;
  double period_us_;                           // at first a USB mouse's, or a PS/2 mouse's
  double frame_us_ = 0, interval_us_ = 1'000;  // the last frame; between two
  double seen_us_ = 0;                         // the frame of the last report
  Bounds bounds_;                              // of the last report's time
  bool started_ = false, located_ = false, moving_ = false;
  std::array<Report, kReports> reports_{};
  int newest_ = 0, known_ = 0;
  std::array<Line, 2> lines_{};
  int run_ = 0;  // fast reports in a row, and the frame of the first
  double run_began_us_ = 0;
};

}  // namespace cabinet
