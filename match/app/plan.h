// The series that each mode plays, and the results that it prints.
#pragma once

#include <string>
#include <vector>

#include "match/report.h"
#include "options.h"

namespace app {

// For --train: the first round.
std::vector<match::SeriesDesc> series_of(const Options& options);

// For --screen and --train.
match::TrainPlan train_plan(const Options& options);

struct Results {
  std::string text;                    // tables for a person
  std::vector<match::Figure> figures;  // the same for CSV and JSON
  bool falls_short = false;            // misses a requirement of the mode: exit code 1
};
// Precondition: the series of series_of(options), in their order.
Results results_of(const Options& options, const std::vector<match::Series>& series);

// series: of all rounds.
Results results_of_training(const match::Training& training,
                            const std::vector<match::Series>& series);

}  // namespace app
