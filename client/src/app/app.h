// The renderer's main loop: hears, draws, sounds, and sends the person's hands.
#pragma once

#include "app/options.h"

namespace client {

// Returns the exit code: 0 done, 1 failed, 4 no display. Says on stderr what went wrong.
int run(const Options& options);

}  // namespace client
