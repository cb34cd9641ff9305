// Fits a rod's index mark to the calibration run, whose turns pass it several times.
#pragma once

#include "cabinet/calibration_fit.h"

namespace cabinet {

// Adds the index mark to a fit. Changes nothing if the mark was not seen. Sets no mark if its
// passes disagree or all have the same direction.
void fit_index(const CalibrationRun& run, const MountPriors& priors, RodFit& fit);

}  // namespace cabinet
