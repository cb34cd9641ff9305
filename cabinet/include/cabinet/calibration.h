// From a sensor's counts to metres and radians, for each rod, read from a JSON file.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "cabinet/rod_input.h"

namespace cabinet {

constexpr double kRodRadius = 0.008;  // [m] of the table's rods, on which the sensors look

// A magnet on the rod that passes under a switch once a turn. Turning forward the switch is on from
// angle - width / 2 + lag to angle + width / 2 + lag, turning back the same with - lag: a switch
// goes on nearer to the magnet than it goes off.
struct IndexMark {
  double angle;    // [rad] of its middle, from feet straight down
  double width;    // [rad]
  double lag = 0;  // [rad]
};

// An increment of the counts c = (slide, spin) moves the rod by
//   d_slide = (1 + slide_gain . (cos angle, sin angle)) m[0] . c
//   d_angle = (1 + spin_gain  . (cos angle, sin angle)) m[1] . c
// with the angle in the middle of the increment. Off-diagonal terms of m undo a sensor that is
// mounted askew. The gains undo an eccentric rod, whose surface comes closer to the sensor and
// moves away once a turn: the sensor counts more of a surface that is closer, and a point further
// from the axis moves more in a turn. The dead band undoes what a sensor loses of a slow motion.
struct RodCalibration {
  double m[2][2];                 // [m / count], [rad / count]
  double slide_gain[2] = {0, 0};  // of angle 0 (feet down) and of a quarter turn
  double spin_gain[2] = {0, 0};
  double dead_band = 0;  // [counts / s] seen of no motion, and lacking of any that is faster
  std::optional<IndexMark> index{};  // none: the rod has none that is known
};

struct RodMotion {
  double slide, angle;  // [m], [rad]
};

// Takes the counts of one rod through its calibration.
class RodIntegrator {
 public:
  explicit RodIntegrator(const RodCalibration& calibration) : calibration_(calibration) {}

  // seconds: since the call before; angle: of the rod before the increment [rad].
  RodMotion add(double slide_counts, double spin_counts, double seconds, double angle);

 private:
  RodCalibration calibration_;
  double still_[2] = {0, 0};  // [s] since either axis had a count
};

struct Calibration {
  std::array<RodCalibration, kRods> rods;
  std::string serial;  // of the controller whose sensors these are; empty: not known
  std::string made;    // when its last rod was calibrated, 2026-11-22T23:59:59Z; empty: not known
};

// Sensors mounted square, at so many counts a millimetre, on rods of the diameter [m].
Calibration nominal_calibration(double counts_per_mm = 8.0, double rod_diameter = 2 * kRodRadius);

// Errors are one sentence: file, what is wrong, what to do. Refused: missing, empty, not JSON, not
// 8 rods, not finite, rows (all but) parallel, or a scale more than 4 times off any known sensor.
tl::expected<Calibration, std::string> load_calibration(const std::string& path);
// The same from text; name stands for the file in the sentence.
tl::expected<Calibration, std::string> parse_calibration(std::string_view json,
                                                         const std::string& name);
// Refuses what load would refuse. The file is replaced whole or not at all.
tl::expected<void, std::string> save_calibration(const Calibration& calibration,
                                                 const std::string& path);

}  // namespace cabinet
