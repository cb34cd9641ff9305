// All eight rods are calibrated at once, each by a person of its own who does what the guide asks,
// through the controller: what the program `space-foosball calibrate` does with one rod after the
// other.
#pragma once

#include "cabinet/calibration.h"
#include "controller.h"
#include "table.h"

namespace cabinet_bench {

struct CalibrationResult {
  cabinet::Calibration calibration;
  double seconds = 0;                   // that the slowest person took
  double slide_rms = 0, angle_rms = 0;  // of the marks' residuals, of the worst rod [m], [rad]
  int marks = 0;                        // rods whose index mark was found
  std::string problem;                  // why a rod was refused; empty: all fit
};

// Afterwards the rods are in the middle, feet down as well as a person sees it.
CalibrationResult calibrate(Controller& controller, Table& table);

}  // namespace cabinet_bench
