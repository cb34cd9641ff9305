// The program around the matches: signals, checkpoint, progress, results. The caller supplies the
// executor: threads of this machine, or the ranks of a cluster.
#pragma once

#include <functional>
#include <string>
#include <tl/expected.hpp>

#include "match/executor.h"
#include "options.h"

namespace app {

using PlayAll = std::function<tl::expected<match::Effort, std::string>(
    match::Schedule&, const match::ExecutorOptions&)>;

// Prints the results, or one sentence about the failure. Returns the exit code.
int run(const Options& options, const PlayAll& play_all);

int fail(int exit_code, const std::string& sentence);
// Handles a Leave of parse(): help, or an error in the options.
int leave(const Leave& leave);

}  // namespace app
