#include "foosball/playability.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

// 1 from `good` on, proportional below.
double rising(double value, double good) {
  return std::clamp(value / good, 0.0, 1.0);
}
// 1 up to `good`, then good / value.
double falling(double value, double good) {
  return value <= good ? 1.0 : good / value;
}

double sum(const PerTeam& counts) {
  return static_cast<double>(counts[0] + counts[1]);
}

}  // namespace

Playability playability_of(const Statistics& s) {
  Playability p;
  const double minutes = static_cast<double>(s.play_ticks) * kTick / 60.0;
  const double matches = static_cast<double>(s.matches());
  const double ball = static_cast<double>(s.ball_ticks);
  if (minutes < 1.0 || matches == 0.0 || ball == 0.0) return p;
  p.rallies = rising(s.rally.mean() - 0.5 * decltype(s.rally)::kWidth, 20.0);
  const double on_target = sum(s.shots_on_target);
  const double saved = on_target > 0.0 ? sum(s.saves) / on_target : 0.0;
  p.saves = rising(saved, 1.0 / 3.0) * rising(1.0 - saved, 1.0 / 3.0);
  p.reach = rising(0.30 - static_cast<double>(s.unreachable_ticks) / ball, 0.25);
  p.surprise = rising(static_cast<double>(s.lead_changes) / matches, 1.0);
  const double length = minutes / matches;
  p.length = rising(length, 2.0) * falling(length, 4.0);
  const double still = static_cast<double>(s.still_ticks) / ball;
  p.flow = falling(still, 0.02) * falling(static_cast<double>(s.dead_balls) / minutes, 0.2);
  p.total = std::pow(p.rallies * p.saves * p.reach * p.surprise * p.length * p.flow, 1.0 / 6.0);
  return p;
}

}  // namespace foosball
