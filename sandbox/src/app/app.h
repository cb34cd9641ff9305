// The sandbox: its window, or without one, a run to the end.
#pragma once

#include "app/options.h"

namespace sandbox {

// The exit code: 0 done, 1 failed, 2 no such scene, 4 no display.
int run(const Options& options);

}  // namespace sandbox
