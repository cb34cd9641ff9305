// Clocks that stand still.
#pragma once

#include <cstdint>

#include "core/simulation.h"

namespace sandbox {

inline const Simulation::Clocks kStopped{[] { return std::int64_t{0}; },
                                         [] { return std::int64_t{0}; }};

}  // namespace sandbox
