// Limits of a rod's motion by hand.
#pragma once

#include <algorithm>
#include <cmath>

#include "cabinet/calibration.h"
#include "state_filter.h"

namespace cabinet {

// No hand moves a rod faster: three times the 3 m/s of a hard push, and nearly twice the 140 rad/s
// of the fastest shots.
inline constexpr double kFastestSlide = 10;  // [m/s]
inline constexpr double kFastestTurn = 250;  // [rad/s]
// Max time that a mouse's report may span before the frame that delivers it: PS/2 at 200 reports a
// second, a USB mouse at 125.
inline constexpr double kLongestReport = 8e-3;  // [s]

// Whether a motion is possible within this time as seen in frames: one frame may bring two reports
// of a mouse whose motion began before it.
inline bool possible(const RodMotion& moved, double seconds) {
  const double longest = seconds + 0.010;
  return std::abs(moved.slide) <= kFastestSlide * longest &&
         std::abs(moved.angle) <= kFastestTurn * longest;
}

// Adds the extrapolation to the measured pose, clamped at the stops. limit 0: no stops.
inline void show_ahead(const RodMotion& measured, const RodAhead& ahead, double limit,
                       RodInput& input) {
  const double slide = measured.slide + ahead.slide;
  input.slide = limit > 0 ? std::clamp(slide, -limit, limit) : slide;
  input.angle = measured.angle + ahead.angle;
  input.slide_ahead = input.slide - measured.slide;
  input.angle_ahead = ahead.angle;
  input.slide_rate = input.slide == slide ? ahead.slide_rate : 0;
  input.angle_rate = ahead.angle_rate;
}

}  // namespace cabinet
