// The program around the matches: signals, checkpoint, progress, results. Who plays is handed in:
// threads of this machine, or the ranks of a cluster.
#pragma once

#include <functional>
#include <string>
#include <tl/expected.hpp>

#include "match/executor.h"
#include "options.h"

namespace app {

using PlayAll = std::function<tl::expected<match::Effort, std::string>(
    match::Schedule&, const match::ExecutorOptions&)>;

// The exit code. Prints the results, or one sentence that says what failed.
int run(const Options& options, const PlayAll& play_all);

int fail(int exit_code, const std::string& sentence);
// For what parse() gave instead of options: help, or what is wrong with them.
int leave(const Leave& leave);

}  // namespace app
