// The calibration of each rod, read from a JSON file: converts sensor counts to metres and radians.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "cabinet/rod_input.h"

namespace cabinet {

constexpr double kRodRadius = 0.008;  // [m] of the table's rods, whose surface the sensors track

// A magnet on the rod that passes a switch once per revolution. Turning forward, the switch is on
// from angle - width / 2 + lag to angle + width / 2 + lag. Turning back, the same with -lag. The
// lag is the hysteresis of the switch: it turns on closer to the magnet than it turns off.
struct IndexMark {
  double angle;    // [rad] of its centre, from feet straight down
  double width;    // [rad]
  double lag = 0;  // [rad]
};

// An increment of the counts c = (slide, spin) moves the rod by
//   d_slide = (1 + slide_gain . (cos angle, sin angle)) m[0] . c
//   d_angle = (1 + spin_gain  . (cos angle, sin angle)) m[1] . c
// with the angle at the middle of the increment. Off-diagonal terms of m correct a sensor that is
// mounted at a skewed angle. The gains correct an eccentric rod. Its surface approaches and recedes
// from the sensor once per revolution. The sensor counts more for a closer surface, and a point
// farther from the axis moves more per revolution. The dead band corrects counts that a sensor
// loses in slow motion.
struct RodCalibration {
  double m[2][2];                 // [m / count], [rad / count]
  double slide_gain[2] = {0, 0};  // coefficients of cos(angle), sin(angle)
  double spin_gain[2] = {0, 0};
  // [counts / s] that the sensor misses: slower motion reads as none, faster as less.
  double dead_band = 0;
  std::optional<IndexMark> index{};  // empty: no known index mark
};

struct RodMotion {
  double slide, angle;  // [m], [rad]
};

// Converts the counts of one rod to motion by its calibration.
class RodIntegrator {
 public:
  explicit RodIntegrator(const RodCalibration& calibration) : calibration_(calibration) {}

  // seconds: time since the previous call. angle: rod angle before the increment [rad].
  RodMotion add(double slide_counts, double spin_counts, double seconds, double angle);

 private:
  RodCalibration calibration_;
  double still_[2] = {0, 0};  // [s] since the last count of each axis
};

struct Calibration {
  std::array<RodCalibration, kRods> rods;
  std::string serial;  // of the controller with these sensors; empty: unknown
  std::string made;    // when the last rod was calibrated, as 2026-11-22T23:59:59Z; empty: unknown
};

// For square-mounted sensors of this resolution, on rods of this diameter [m].
Calibration nominal_calibration(double counts_per_mm = 8.0, double rod_diameter = 2 * kRodRadius);

// An error is one sentence: the file, what is wrong, what to do. Rejects a file that is missing,
// empty or not JSON, and values for other than 8 rods, non-finite values, (nearly) parallel rows,
// and a scale more than a factor of 4 from that of any known sensor.
tl::expected<Calibration, std::string> load_calibration(const std::string& path);
// The same from text. The error names the file as `name`.
tl::expected<Calibration, std::string> parse_calibration(std::string_view json,
                                                         const std::string& name);
// Rejects what load_calibration rejects. Replaces the file atomically.
tl::expected<void, std::string> save_calibration(const Calibration& calibration,
                                                 const std::string& path);

}  // namespace cabinet
