// A match whose rods are moved by simulated hands on a simulated cabinet. Computer players set the
// hands' targets, the hands move the rods with the force of real hands, the sensors count, the
// controller's firmware sends frames, and the server plays the match from these frames.
#pragma once

#include <cstdint>
#include <vector>

#include "cabinet/calibration.h"
#include "controller.h"
#include "mark_watch.h"
#include "table.h"

namespace cabinet_bench {

// Errors at each tick and rod.
struct Errors {
  std::vector<float> slide, angle;  // absolute [m], [rad]

  void add(const Pose& is, const Pose& should);
  // Of the last ticks only: what has drifted by then.
  Errors last(std::size_t ticks) const;
};
struct Spread {
  double rms = 0, p99 = 0, max = 0;
};
Spread spread(std::vector<float> absolute);
// Fraction of the ticks and rods within both bounds.
double share_within(const Errors& errors, double slide, double angle);

struct PulseCounts {
  std::uint64_t hits = 0;    // of men, in the match
  std::uint64_t pulses = 0;  // commands that the server sent
  std::uint64_t begun = 0;   // at the right motor, with the right strength
  std::uint64_t merged = 0;  // a later pulse came first, or the motor already ran at this strength
  std::uint64_t missing = 0, stray = 0, not_ended = 0;
  std::vector<float> latency_us;  // from the command to the driver's register
  // Of pulses with a free bus: no other pulse began or ended in between.
  std::vector<float> free_latency_us;
};

struct MatchOptions {
  double max_seconds = 600;
  int level = 4;
  std::uint64_t seed = 1;
  bool swings = true;  // people re-zero their rods before the match and after each goal
};
struct MatchResult {
  double seconds = 0;
  std::array<int, 2> score{};
  bool over = false;
  Errors input;  // a tick's input against the hand at the tick
  Errors rod;    // the match's rod at the tick's end: a ball may block it, but not the hand
  Errors free;   // ... as it would be without contact with a ball
  Errors ideal;  // ... and with the true input: the remaining error is the rod's inertia
  double fastest_slide = 0, fastest_angle = 0;  // of the hands [m/s], [rad/s]
  std::uint64_t frames = 0, lost = 0, bad = 0, overflows = 0, impossible = 0, line_errors = 0;
  PulseCounts pulses;
  MarkCounts marks;
  std::uint64_t disagreements = 0;  // of marks with the counts
};

// Starts with the rods centred; the server assumes that their feet are straight down.
MatchResult play_match(Controller& controller, Table& table,
                       const cabinet::Calibration& calibration, const MatchOptions& options);

}  // namespace cabinet_bench
