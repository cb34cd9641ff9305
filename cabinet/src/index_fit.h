// A rod's index mark from the run that calibrates the rod: the turns pass it several times.
#pragma once

#include "cabinet/calibration_fit.h"

namespace cabinet {

// Adds to a fit what the run shows of the mark: nothing, if it was not seen; no mark, if it was but
// its passes do not agree, or are all one way.
void fit_index(const CalibrationRun& run, const MountPriors& priors, RodFit& fit);

}  // namespace cabinet
