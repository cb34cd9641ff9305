// Calibrates all eight rods at once through the controller. A separate simulated person for each
// rod follows the guide. The program `space-foosball calibrate` does the same with one rod after
// the other.
#pragma once

#include "cabinet/calibration.h"
#include "controller.h"
#include "table.h"

namespace cabinet_bench {

struct CalibrationResult {
  cabinet::Calibration calibration;
  double seconds = 0;                   // of the slowest person
  double slide_rms = 0, angle_rms = 0;  // residuals of the marks, of the worst rod [m], [rad]
  int marks = 0;                        // number of rods whose index mark was found
  std::string problem;                  // why a rod's fit failed; empty: all fits succeeded
};

// Afterwards the rods are centred, feet down as accurately as a person sees it.
CalibrationResult calibrate(Controller& controller, Table& table);

}  // namespace cabinet_bench
