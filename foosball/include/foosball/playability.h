// How well a game plays, as one number from 0 to 1: the geometric mean of its parts, so that none
// can make up for one that is missing. Each part is 1 where play is as good as it is meant to be,
// and falls off on either side. The study of the tuning values maximizes it; docs/match-runner.md
// says why each part stands where it does.
#pragma once

#include "foosball/statistics.h"

namespace foosball {

struct Playability {
  double rallies = 0.0;   // the ball changes sides often before play stops: a mean of 20 and more
  double saves = 0.0;     // a third to two thirds of the shots on target are saved
  double reach = 0.0;     // share of time in which somebody can act: from 70 % (0) to 95 % (1)
  double surprise = 0.0;  // changes of lead: 1 a match and more
  double length = 0.0;    // a match takes 2 to 4 minutes of play
  double flow = 0.0;      // the ball is hardly ever still or dead: under 2 % and 0.2 a minute
  double total = 0.0;
};

// All parts are 0 without a minute of play.
Playability playability_of(const Statistics& statistics);

}  // namespace foosball
