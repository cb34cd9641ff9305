#pragma once

#include <vector>

#include "cabinet/doctor.h"

namespace cabinet {

// The troubles of the devices found and examined, in the order in which a person would check them.
std::vector<Trouble> troubles_of(const Diagnosis& diagnosis);

}  // namespace cabinet
