// Quality of play as one number from 0 to 1: the geometric mean of its parts, so that a part near 0
// cannot be compensated by others. Each part is 1 in its intended range and decreases on either
// side. The study of the tuning values maximizes it. docs/match-runner.md explains the range of
// each part.
#pragma once

#include "foosball/statistics.h"

namespace foosball {

struct Playability {
  double rallies = 0.0;  // mean number of changes of side before play stops: 20 and more
  double saves = 0.0;    // fraction of shots on target that are saved: a third to two thirds
  double reach = 0.0;    // fraction of time in which a man can reach the ball: 70 % (0) to 95 % (1)
  double surprise = 0.0;  // changes of lead per match: 1 and more
  double length = 0.0;    // playing time of a match: 2 to 4 minutes
  double flow = 0.0;  // the ball is rarely still or dead: under 2 % of the time, 0.2 times a minute
  double total = 0.0;
};

// All parts are 0 if less than a minute was played.
Playability playability_of(const Statistics& statistics);

}  // namespace foosball
