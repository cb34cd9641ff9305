// From a sensor's counts to metres and radians: a linear map for each rod, read from a JSON file.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "cabinet/rod_input.h"

namespace cabinet {

constexpr double kRodRadius = 0.008;  // [m] of the table's rods, on which the sensors look

// d_slide = m[0][0] d_counts_slide + m[0][1] d_counts_spin   [m / count]
// d_angle = m[1][0] d_counts_slide + m[1][1] d_counts_spin   [rad / count]
// Off-diagonal terms undo a tilted sensor. The map acts on increments of the wrapping counts.
struct RodCalibration {
  double m[2][2];
};

struct Calibration {
  std::array<RodCalibration, kRods> rods;
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
