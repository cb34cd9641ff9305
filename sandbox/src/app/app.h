// The sandbox: an interactive window, or a run to the end without one.
#pragma once

#include "app/options.h"

namespace sandbox {

// Returns the exit code: 0 success, 1 failure, 2 no such scene, 4 no display.
int run(const Options& options);

}  // namespace sandbox
