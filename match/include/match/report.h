// Statistics of play and their goals; docs/match-runner.md defines them.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "match/player.h"
#include "match/schedule.h"

namespace match {

struct Figure {
  std::string section, name;
  double value = 0.0;
  std::string unit;
  std::string goal;  // as text; empty: none
  // open: the goal's bound is within two standard errors of the value.
  enum class Judgment { none, pass, falls_short, open, unknown } judgment = Judgment::none;
  double error = std::numeric_limits<double>::quiet_NaN();  // standard error; NaN: not known
};

std::vector<Figure> figures_of(const std::string& section, const foosball::Statistics& statistics);

std::string as_table(const std::vector<Figure>& figures);
std::string as_csv(const std::vector<Figure>& figures);
std::string as_json(const std::vector<Figure>& figures);

// The matches of --report: between the two players, and of reference opponents against them.
struct ReportPlan {
  std::string home = default_player(), away = default_player();
  foosball::Layout layout = foosball::Layout::tournament;
  std::uint64_t seed = 1, max_ticks = 600'000;
  std::uint64_t matches = 100;
  foosball::Tuning tuning{};
  foosball::Characters character_list = foosball::built_in_characters();
};
std::vector<SeriesDesc> report_series(const ReportPlan& plan);
// Precondition: the series of report_series(plan), in their order.
std::vector<Figure> report_figures(const ReportPlan& plan, const std::vector<Series>& series);

// The matches of --stuck-balls: every level against itself in both layouts. They measure for how
// long no man could reach the ball, or nobody played it. Ignores the plan's players and layout.
std::vector<SeriesDesc> stuck_ball_series(const ReportPlan& plan);
std::vector<Figure> stuck_ball_figures(const std::vector<Series>& series);

bool any_short(const std::vector<Figure>& figures);

}  // namespace match
