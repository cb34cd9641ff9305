// A TaskScheduler on oneTBB: library vphysics_tbb (CMake VirtualPhysics::vphysics_tbb).
#pragma once

#include <memory>

#include "vphysics/task_scheduler.h"

namespace vp {

// workers: maximum number of threads, the caller's included; 0: the number of hardware threads. The
// object may serve any number of worlds, one after another.
std::shared_ptr<TaskScheduler> make_tbb_task_scheduler(int workers = 0);

}  // namespace vp
