// Moves all rods and injects faults at random times. Checks that no loss of counts goes uncounted.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "controller.h"
#include "ledger.h"

namespace cabinet_bench {

struct FaultOptions {
  double seconds = 60;
  double troubles_per_minute = 20;
  std::uint32_t seed = 1;
};
struct FaultResult {
  std::map<std::string, int> troubles;  // number by name
  Ledger::Totals totals;
  std::vector<std::string> violations;
};

FaultResult run_faults(Controller& controller, const FaultOptions& options);

}  // namespace cabinet_bench
