#pragma once

#include <vector>

#include "cabinet/doctor.h"

namespace cabinet {

// The troubles of what was found and listened to, in the order of a person who looks for them.
std::vector<Trouble> troubles_of(const Diagnosis& diagnosis);

}  // namespace cabinet
