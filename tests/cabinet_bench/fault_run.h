// Hands that move all rods, and troubles at random times: is anything lost without being counted?
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
  std::map<std::string, int> troubles;  // by name, how many
  Ledger::Totals totals;
  std::vector<std::string> violations;
};

FaultResult run_faults(Controller& controller, const FaultOptions& options);

}  // namespace cabinet_bench
