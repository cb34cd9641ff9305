// What each mode plays, and what it prints of it.
#pragma once

#include <string>
#include <vector>

#include "match/report.h"
#include "options.h"

namespace app {

std::vector<match::SeriesDesc> series_of(const Options& options);

struct Results {
  std::string text;                    // tables for a person
  std::vector<match::Figure> figures;  // the same for CSV and JSON
};
// Precondition: the series of these options, in their order.
Results results_of(const Options& options, const std::vector<match::Series>& series);

}  // namespace app
