// Figures of play, each beside its goal; docs/match-runner.md defines them.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "match/schedule.h"

namespace match {

struct Figure {
  std::string section, name;
  double value = 0.0;
  std::string unit;
  std::string goal;  // as text; empty: none
  enum class Judgment { none, pass, falls_short, unknown } judgment = Judgment::none;
  double error = std::numeric_limits<double>::quiet_NaN();  // standard error, where known
};

std::vector<Figure> figures_of(const std::string& section, const foosball::Statistics& statistics);

std::string as_table(const std::vector<Figure>& figures);
std::string as_csv(const std::vector<Figure>& figures);
std::string as_json(const std::vector<Figure>& figures);

// The matches of --report: the two players, and what a reviewer of play tried against them.
struct ReportPlan {
  std::string home = "classic", away = "classic";
  foosball::Layout layout = foosball::Layout::tournament;
  std::uint64_t seed = 1, max_ticks = 600'000;
  std::uint64_t matches = 100;
  foosball::Tuning tuning{};
  foosball::Characters character_list = foosball::built_in_characters();
};
std::vector<SeriesDesc> report_series(const ReportPlan& plan);
// Precondition: the series of that plan, in their order.
std::vector<Figure> report_figures(const ReportPlan& plan, const std::vector<Series>& series);

}  // namespace match
