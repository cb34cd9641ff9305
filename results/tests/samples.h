// Matches for tests.
#pragma once

#include <string>

#include "results/match_result.h"

namespace results {

inline MatchResult match_between(const std::string& a, const std::string& b, std::uint32_t goals_a,
                                 std::uint32_t goals_b, int minute = 0) {
  MatchResult match;
  match.finished_at =
      "2026-11-22T20:" + std::string(minute < 10 ? "0" : "") + std::to_string(minute) + ":00Z";
  match.layout = "tournament";
  match.goals_to_win = 5;
  match.max_goals = 8;
  match.seed = 18446744073709551615u;
  match.play_seconds = 123.5;
  match.teams[0] = {{{a, "person"}}, goals_a, TeamStatistics{7, 5, 2, 11, 40, 1, 60.25, 9.25}};
  match.teams[1] = {{{b, "computer"}}, goals_b, TeamStatistics{3, 1, 4, 2, 33, 0, 50.0, 8.5}};
  match.shot_speeds = ShotSpeeds{5.5, 9.25};
  match.recording = "/tmp/match.sfr";
  return match;
}

}  // namespace results
