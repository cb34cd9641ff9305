// Speeds of error correction for contacts and joints, and the number of sub-steps.
#pragma once

#include <cmath>

#include "vphysics/world.h"

namespace vp {

// kUseBias: fraction of a penetration that a sub-step corrects. kMaxBiasVelocity: max bias
// velocity. kMaxCorrectionSpeed: max speed of the position correction, which moves the bodies
// themselves. Both in [m/s] for bodies of a metre; for a body with n > kMaxUnscaledContacts
// contacts both are multiplied by kMaxUnscaledContacts / n. In short sub-steps the max bias
// velocity is larger, so that a depth of kSmallDepth [m for bodies of a metre] is corrected at the
// full rate: single precision may leave such a depth.
inline constexpr double kUseBias = 0.1;
inline constexpr double kMaxBiasVelocity = 0.25;
inline constexpr double kMaxCorrectionSpeed = 3.0;
inline constexpr double kMaxUnscaledContacts = 6.0;
inline constexpr double kSmallDepth = 1e-3;
// Max speed at which joints correct their errors [m/s for bodies of a metre].
inline constexpr double kMaxJointCorrectionSpeed = 3.0;

// A hard joint is a position error if it is open by more than kMaxJointSeparation times the smaller
// body's size, or rotated by more than kRotationError [rad].
inline constexpr double kMaxJointSeparation = 0.5;
inline constexpr double kRotationError = 0.2;

// A joint limit gets a row, in steps h, if its distance is below this: twice the distance covered
// at the current speed, since an impulse may add to it, plus that at 1 m/s or 1 rad/s.
inline double stop_range(double h, double speed) {
  return h * (2.0 * std::fabs(speed) + 1.0);
}

int sub_steps_in(const WorldDesc& desc, double speed_unit, double dt);

}  // namespace vp
