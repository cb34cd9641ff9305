// What no calibration of a rod may be, whether a file or a fit says it.
#pragma once

#include <optional>
#include <string>

#include "cabinet/calibration.h"

namespace cabinet {

// The rest of a sentence that begins with the rod: what is wrong, and what to do. None: it is
// sound.
std::optional<std::string> check_rod(const RodCalibration& rod);

}  // namespace cabinet
