// A match whose rods are moved by simulated hands on a simulated cabinet: computer players say
// where the hands go, hands move the rods as strongly as hands do, sensors count, the controller's
// firmware sends frames, and the server's match is played by what comes out of them.
#pragma once

#include <cstdint>
#include <vector>

#include "cabinet/calibration.h"
#include "controller.h"
#include "mark_watch.h"
#include "table.h"

namespace cabinet_bench {

// How far off, at each tick and rod.
struct Errors {
  std::vector<float> slide, angle;  // absolute [m], [rad]

  void add(const Pose& is, const Pose& should);
  // Of the last ticks alone: what has drifted by then.
  Errors last(std::size_t ticks) const;
};
struct Spread {
  double rms = 0, p99 = 0, most = 0;
};
Spread spread(std::vector<float> absolute);
// Of the ticks and rods that are within both.
double share_within(const Errors& errors, double slide, double angle);

struct PulseCounts {
  std::uint64_t hits = 0;    // of men, in the match
  std::uint64_t pulses = 0;  // commands that the server sent
  std::uint64_t begun = 0;   // at the right motor, with the right strength
  std::uint64_t merged = 0;  // a later one of the rod came before it, or its motor ran so already
  std::uint64_t missing = 0, stray = 0, not_ended = 0;
  std::vector<float> latency_us;  // from the command to the driver's register
  // Of those for which the bus was free: no pulse began or ended in between.
  std::vector<float> free_latency_us;
};

struct MatchOptions {
  double most_seconds = 600;
  int level = 4;
  std::uint64_t seed = 1;
  bool swings = true;  // people re-zero their rods before the match and after each goal
};
struct MatchResult {
  double seconds = 0;
  std::array<int, 2> score{};
  bool over = false;
  Errors input;  // what a tick is given, to the hand at the tick
  Errors rod;    // the match's rod, at the tick's end: a ball may hold it, but not the hand
  Errors free;   // ... as it would be if it touched no ball
  Errors ideal;  // ... and if a tick were given the truth: what is left is the rod's inertia
  double fastest_slide = 0, fastest_angle = 0;  // of the hands [m/s], [rad/s]
  std::uint64_t frames = 0, lost = 0, bad = 0, overflows = 0, impossible = 0, line_errors = 0;
  PulseCounts pulses;
  MarkCounts marks;
  std::uint64_t disagreements = 0;  // of marks with the counts
};

// From rods in the middle, whose feet the server takes to be straight down.
MatchResult play_match(Controller& controller, Table& table,
                       const cabinet::Calibration& calibration, const MatchOptions& options);

}  // namespace cabinet_bench
