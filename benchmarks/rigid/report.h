// What ./bench rigid prints and keeps.
#pragma once

#include <string>
#include <vector>

#include "measure.h"

namespace rigid {

// Of one scene at one rate.
std::string table(const std::vector<Figure>& figures);
// What was to be reached beside what was; empty: nothing of it was measured.
std::string goals_table(const std::vector<Figure>& figures);
// subject,engine,metric,value,unit; goals as the engine "goal".
std::string csv(const std::vector<Figure>& figures);

}  // namespace rigid
