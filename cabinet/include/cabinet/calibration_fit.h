// Fits the calibration of one rod to a recorded calibration run: Section 5 of the paper, "by
// curve-fitting the actual values of rotational and axial motions with raw sensor signals".
//
// The person moves the rod to known positions and marks them: an end stop (slide), feet straight
// down (angle). Between two marks of the same kind, the calibrated increments must add up to the
// known difference. The fit minimizes the squares of
//   r_k = (sum of the increments' motions from mark k - 1 to mark k  -  known difference) / sigma
// over the nine parameters of RodCalibration. Cauchy weights reduce the influence of outliers, such
// as a mark set too early or a single slip of the sensor. Priors (MountPriors) constrain parameters
// that the run does not determine. Method: Levenberg-Marquardt; Nocedal and Wright, Numerical
// Optimization, 2nd ed., chapter 10.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "cabinet/calibration.h"

namespace cabinet {

// The counts between two frames.
struct CountIncrement {
  std::int16_t slide, spin;
  float seconds;
  bool mark = false;  // at the end of the increment, the index mark is under its switch
};

struct CalibrationMark {
  enum class Kind { slide, angle };
  std::size_t at;  // number of increments before the mark
  Kind kind;
  double value;  // [m] or [rad]; angles are not wrapped
};

// One rod, starting with its feet straight down: the first angle mark gives the initial angle.
struct CalibrationRun {
  std::vector<CountIncrement> increments;
  std::vector<CalibrationMark> marks;  // in ascending order of `at`
};

// Prior knowledge of a mount. "Deviation" is a standard deviation.
struct MountPriors {
  double rod_radius = kRodRadius;   // [m]
  double optical_distance = 0.005;  // [m] at which counts per metre are inverse to the distance
  double axis_scale = 0.01;  // deviation of the ratio of the axes' scales: the rod's diameter
  // [rad] deviation of the angle between the axes: pixels are square, and a sensor that leans by 4
  // degrees sees 0.24 % less in one direction.
  double right_angle = 0.0015;
  // Deviation of spin_gain from the value given by slide_gain and geometry.
  double gain_ratio = 0.006;
  double dead_band = 20;      // [counts / s] deviation from zero
  double stop_error = 2e-4;   // [m] deviation of a mark at an end stop
  double angle_error = 0.03;  // [rad] deviation of a mark with feet straight down
};

inline constexpr int kFitted = 9;  // m row by row, slide_gain, spin_gain, dead_band

struct RodFit {
  RodCalibration calibration;
  std::array<double, kFitted> deviation;  // standard deviation of each parameter, in that order
  struct Residual {
    CalibrationMark mark;
    double value;  // [m] or [rad]: fitted minus known motion since the previous mark of this kind
    bool outlier;  // more than 5 deviations from zero: has almost no weight
  };
  std::vector<Residual> residuals;
  double slide_rms, angle_rms;  // [m], [rad] of the residuals that are not outliers
  // Passes of the index mark. If they agree, calibration.index is set.
  int index_passes = 0;
  double index_deviation = 0;  // [rad] standard deviation of its centre
};

// The error is a sentence that says what is wrong with the run and what to do: marks out of order
// or out of range, a missing motion (strokes at several angles, turns at a stop), too many
// outliers, residuals too large, or a calibration that save_calibration would reject.
tl::expected<RodFit, std::string> fit_rod(const CalibrationRun& run,
                                          const MountPriors& priors = {});

}  // namespace cabinet
