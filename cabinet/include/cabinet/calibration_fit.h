// The calibration of one rod from what a person did with it: Section 5 of the paper, "by
// curve-fitting the actual values of rotational and axial motions with raw sensor signals".
//
// The person brings the rod to places that are known, and marks them: an end stop (slide), feet
// straight down (angle). Between two marks of a kind the calibrated increments must add up to the
// known difference. The fit minimizes the squares of
//   r_k = (sum of the increments' motions from mark k - 1 to mark k  -  known difference) / sigma
// over the nine numbers of RodCalibration, with a weight on each that falls for what lies far off
// (Cauchy), so that a mark that was set too early or a sensor that slipped once does no harm, and
// with what is known of any mount beforehand (Priors), for what a run does not show. Levenberg and
// Marquardt's steps; Nocedal and Wright, Numerical Optimization, 2nd ed., chapter 10.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "cabinet/calibration.h"

namespace cabinet {

// Of the counts between two frames.
struct CountIncrement {
  std::int16_t slide, spin;
  float seconds;
  bool mark = false;  // the rod's index mark is under its switch at their end
};

struct CalibrationMark {
  enum class Kind { slide, angle };
  std::size_t at;  // after so many increments
  Kind kind;
  double value;  // [m] or [rad]; angles count on over whole turns
};

// One rod, from feet straight down: the first mark of an angle gives the angle of the beginning.
struct CalibrationRun {
  std::vector<CountIncrement> increments;
  std::vector<CalibrationMark> marks;  // in the order of at
};

// What is known beforehand.
struct MountPriors {
  double rod_radius = kRodRadius;   // [m]
  double optical_distance = 0.005;  // [m] at which counts per metre are inverse to the distance
  double axis_scale = 0.01;     // of the axes' scales to each other, deviation: the rod's diameter
  double right_angle = 0.0015;  // [rad] between the axes: pixels are square, and a sensor that
                                // leans by 4 degrees sees 0.24 % less of one direction
  double gain_ratio = 0.006;  // of spin_gain about what slide_gain and the geometry say, deviation
  double dead_band = 20;      // [counts / s], deviation about none
  double stop_error = 2e-4;   // [m] of a mark at an end stop, deviation
  double angle_error = 0.03;  // [rad] of a mark with feet straight down, deviation
};

inline constexpr int kFitted = 9;  // m row by row, slide_gain, spin_gain, dead_band

struct RodFit {
  RodCalibration calibration;
  std::array<double, kFitted> deviation;  // standard, of each number in that order
  struct Residual {
    CalibrationMark mark;
    double value;  // [m] or [rad]: fitted less known motion since the mark of its kind before it
    bool outlier;  // more than 5 deviations off: it hardly counted
  };
  std::vector<Residual> residuals;
  double slide_rms, angle_rms;  // [m], [rad] of the residuals that are no outliers
  // Of the index mark: calibration.index has it, if its passes agree.
  int index_passes = 0;
  double index_deviation = 0;  // [rad] standard, of its middle
};

// The error is a sentence that says what is wrong with the run and what to do: marks out of order
// or out of range, a motion that is missing (strokes at several angles, turns at a stop), too many
// outliers, residuals too large, a calibration that a file would refuse.
tl::expected<RodFit, std::string> fit_rod(const CalibrationRun& run,
                                          const MountPriors& priors = {});

}  // namespace cabinet
