// A world's work by oneTBB: library vphysics_tbb (CMake VirtualPhysics::vphysics_tbb).
#pragma once

#include <memory>

#include "vphysics/jobs.h"

namespace vp {

// workers: how many threads at most take part, the caller's included; 0: as many as the machine
// has. The object may serve any number of worlds, one after another.
std::shared_ptr<Jobs> make_tbb_jobs(int workers = 0);

}  // namespace vp
