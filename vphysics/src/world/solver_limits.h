// How fast contacts and joints take out their errors, and in how many sub-steps.
#pragma once

#include <cmath>

#include "vphysics/world.h"

namespace vp {

// Share of a penetration that a sub-step pushes out, the fastest that velocities push, and the
// fastest with what moves the bodies themselves [m/s of things of a metre]. A body of more contacts
// than kCrowd shares both. In short sub-steps velocities push out kSmallDepth [m of such things] at
// once, which may be what single precision leaves.
inline constexpr double kUseBias = 0.1;
inline constexpr double kMaxBiasVelocity = 0.25;
inline constexpr double kFastestShift = 3.0;
inline constexpr double kCrowd = 6.0;
inline constexpr double kSmallDepth = 1e-3;
// How fast joints take out their errors [m/s of things of a metre].
inline constexpr double kFastestJoint = 3.0;

// Joints that hold hard and are open by more than this share of the smaller body's size, or turned
// by more than this [rad], are a position error.
inline constexpr double kOpen = 0.5;
inline constexpr double kRotationError = 0.2;

// Stops of joints get rows, in steps h, if they are nearer than this: twice as far as the present
// rate leads, since an impulse may add to it, and than a metre or a radian a second more.
inline double stop_range(double h, double speed) {
  return h * (2.0 * std::fabs(speed) + 1.0);
}

int sub_steps_in(const WorldDesc& desc, double speed_unit, double dt);

}  // namespace vp
