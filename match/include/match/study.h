// What the tuning values do to play: a design of points in their ranges, at each of them a series
// of matches in both layouts, and of each series the figures of playability. docs/tuning-study.md
// has the results.
#pragma once

#include <string>
#include <vector>

#include "match/player.h"
#include "match/report.h"
#include "match/schedule.h"

namespace match {

struct StudyPlan {
  std::string player = default_player();  // plays both sides
  std::uint64_t seed = 1;  // of the first pair at every point: all points play the same serves and
                           // characters
  std::uint64_t max_ticks = 600'000;
  std::uint64_t matches = 100;  // at each point, in each layout
  std::uint64_t samples = 64;   // points that fill the space
  foosball::Characters character_list = foosball::built_in_characters();
  foosball::Tuning tuning{};  // that the values are varied about; in its ranges
};

// A value that is varied, and between which ends: a part of its range, in which a match is still
// one.
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
// The values of `about`, which are called defaults; each value alone at the levels 0, 1/4, 1/2, 3/4
// and 1 between its ends; and samples of the whole box, by the Halton sequence (halton1960): low
// discrepancy, and the same at every run.
std::vector<StudyPoint> study_points(std::uint64_t samples, const foosball::Tuning& about = {});

// For each point one series in the tournament layout and one in the paper's.
std::vector<SeriesDesc> study_series(const StudyPlan& plan);
// A section for each series: "tournament; " or "paper; " and the point's name. Precondition: the
// series of that plan, in their order.
std::vector<Figure> study_figures(const StudyPlan& plan, const std::vector<Series>& series);

}  // namespace match
