// Statistics of one match, as stored in the results: the difference of an observer's counts.
#pragma once

#include <array>
#include <optional>

#include "foosball/statistics.h"
#include "results/match_result.h"

namespace server {

std::array<results::TeamStatistics, foosball::kTeams> statistics_of_teams(
    const foosball::Statistics& before, const foosball::Statistics& now);
// None if nobody shot. Resolution: the width of a bin, 0.1 m/s.
std::optional<results::ShotSpeeds> shot_speeds(const foosball::Statistics& before,
                                               const foosball::Statistics& now);

}  // namespace server
