// The renderer's main loop: receives, draws, plays sounds and sends the people's input.
#pragma once

#include "app/options.h"

namespace client {

// Returns the exit code: 0 success, 1 failure, 4 no display. Prints errors to stderr.
int run(const Options& options);

}  // namespace client
