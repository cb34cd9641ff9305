// The effect of the tuning values on play. A design of points in their ranges; at each point a
// series of matches in both layouts; from each series the statistics of playability.
// docs/tuning-study.md has the results.
#pragma once

#include <string>
#include <vector>

#include "match/player.h"
#include "match/report.h"
#include "match/schedule.h"

namespace match {

struct StudyPlan {
  std::string player = default_player();  // for both teams
  // Of the first pair at every point: all points have the same serves and characters.
  std::uint64_t seed = 1;
  std::uint64_t max_ticks = 600'000;
  std::uint64_t matches = 100;  // per point and layout
  std::uint64_t samples = 64;   // number of space-filling points
  foosball::Characters character_list = foosball::built_in_characters();
  foosball::Tuning tuning{};  // centre of the variation; must be in its ranges
};

// A varied value and its limits: a part of its range in which the game remains playable.
struct StudiedValue {
  const char* name;
  double low, high;
};
const std::vector<StudiedValue>& studied_values();

struct StudyPoint {
  std::string
      name;  // "defaults gravity=12 ...", "one gravity=9.8", "fill gravity=12.1 hop_gain=1.7 ..."
  foosball::Tuning tuning;
};
// Three sets of points: `about`, called defaults; each value alone at the levels 0, 1/4, 1/2, 3/4
// and 1 between its limits; and samples of the whole box by the Halton sequence (halton1960), which
// has low discrepancy and is reproducible.
std::vector<StudyPoint> study_points(std::uint64_t samples, const foosball::Tuning& about = {});

// For each point one series in the tournament layout and one in the paper's layout.
std::vector<SeriesDesc> study_series(const StudyPlan& plan);
// One section per series: "tournament; " or "paper; " and the point's name. Precondition: the
// series of study_series(plan), in their order.
std::vector<Figure> study_figures(const StudyPlan& plan, const std::vector<Series>& series);

}  // namespace match
