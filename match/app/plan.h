// What each mode plays, and what it prints of it.
#pragma once

#include <string>
#include <vector>

#include "match/report.h"
#include "options.h"

namespace app {

// Of --train, the first round.
std::vector<match::SeriesDesc> series_of(const Options& options);

// Of --screen and --train.
match::TrainPlan train_plan(const Options& options);

struct Results {
  std::string text;                    // tables for a person
  std::vector<match::Figure> figures;  // the same for CSV and JSON
  bool falls_short = false;            // of what the mode demands: exit code 1
};
// Precondition: the series of these options, in their order.
Results results_of(const Options& options, const std::vector<match::Series>& series);

// Of all rounds.
Results results_of_training(const match::Training& training,
                            const std::vector<match::Series>& series);

}  // namespace app
