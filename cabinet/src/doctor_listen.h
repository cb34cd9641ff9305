#pragma once

#include <vector>

#include "cabinet/calibration.h"
#include "cabinet/doctor.h"

namespace cabinet {

// Fills in what the device shows while nobody is to touch it.
void listen_to_controller(FoundDevice& device, const Calibration& calibration,
                          const DoctorOptions& options);
// Mice and gamepads among them that may be read, all at once.
void listen_to_inputs(std::vector<FoundDevice>& devices, const DoctorOptions& options);

}  // namespace cabinet
