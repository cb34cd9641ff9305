// What a person is told in a calibration, in the window and on the terminal.
#pragma once

#include <string>
#include <vector>

#include "session.h"

namespace calibrate {

std::string rod_words(foosball::Layout layout, int rod);  // "Rod 3: midfield of team 1"
// What to do now: of the guide, or of a fit that is there or was refused.
std::string request_words(const Session& session);
// What keeps it from going on; empty: nothing.
std::string advice_words(const Session& session);
// The coefficients with their deviations, and what is left over; a line each.
std::vector<std::string> fit_words(const cabinet::RodFit& fit);

}  // namespace calibrate
