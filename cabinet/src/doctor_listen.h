#pragma once

#include <vector>

#include "cabinet/calibration.h"
#include "cabinet/doctor.h"

namespace cabinet {

// Fills in the results of listening to a device while nobody touches it.
void listen_to_controller(FoundDevice& device, const Calibration& calibration,
                          const DoctorOptions& options);
// Listens to all readable mice and gamepads among them at once.
void listen_to_inputs(std::vector<FoundDevice>& devices, const DoctorOptions& options);

}  // namespace cabinet
