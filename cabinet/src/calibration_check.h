// Validity checks of a rod's calibration, for a file or a fit.
#pragma once

#include <optional>
#include <string>

#include "cabinet/calibration.h"

namespace cabinet {

// Returns the rest of a sentence that begins with the rod: what is wrong, and what to do. Empty:
// the calibration is valid.
std::optional<std::string> check_rod(const RodCalibration& rod);

}  // namespace cabinet
