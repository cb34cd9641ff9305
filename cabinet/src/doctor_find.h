#pragma once

#include <vector>

#include "cabinet/doctor.h"

namespace cabinet {

// Controllers, mice and gamepads below dev, as sys describes them, by path.
std::vector<FoundDevice> find_devices(const std::string& dev, const std::string& sys);

}  // namespace cabinet
