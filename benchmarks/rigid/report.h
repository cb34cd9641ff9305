// The output of ./bench rigid: tables and CSV rows.
#pragma once

#include <string>
#include <vector>

#include "measure.h"

namespace rigid {

// The results of one scene at one rate.
std::string table(const std::vector<Figure>& figures);
// The goals and the measured values; empty: nothing was measured for them.
std::string goals_table(const std::vector<Figure>& figures);
// subject,engine,metric,value,unit; goals as the engine "goal".
std::string csv(const std::vector<Figure>& figures);

}  // namespace rigid
