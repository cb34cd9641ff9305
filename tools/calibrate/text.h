// The texts of a calibration, for the window and the terminal.
#pragma once

#include <string>
#include <vector>

#include "session.h"

namespace calibrate {

std::string rod_text(foosball::Layout layout, int rod);  // "Rod 3: midfield of team 1"
// What to do now: the guide's step, or after a successful or failed fit.
std::string request_text(const Session& session);
// What blocks the progress; empty: nothing.
std::string advice_text(const Session& session);
// The coefficients with their standard deviations, and the residuals; one line each.
std::vector<std::string> fit_text(const cabinet::RodFit& fit);

}  // namespace calibrate
