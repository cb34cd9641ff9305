// Interpolates the scene between two snapshots, and extrapolates a little beyond the newest. Pure
// functions.
//
// Positions follow the cubic Hermite curve through both ends with their velocities; it is exact for
// uniformly accelerated motion. Orientations rotate at a constant rate along the shortest arc.
#pragma once

#include "wire/snapshot.h"

namespace client {

// A pose that jumps (a new serve) is not interpolated: at a higher speed than this, the earlier
// pose is shown until the time of the later one. Twice the fastest shot of a real table [m/s].
inline constexpr double kJumpSpeed = 40.0;

// share: fraction 0..1 of the time from a to b, which are span_s [s] apart. Precondition: span_s >
// 0.
wire::PoseVelocity interpolate(const wire::PoseVelocity& a, const wire::PoseVelocity& b,
                               double share, double span_s);
// Discrete values (score, screen, status) are those of a until b is reached.
wire::Snapshot interpolate(const wire::Snapshot& a, const wire::Snapshot& b, double share,
                           double span_s);

// Linear motion with the velocities of `last`; seconds >= 0.
wire::PoseVelocity extrapolate(const wire::PoseVelocity& last, double seconds);
wire::Snapshot extrapolate(const wire::Snapshot& last, double seconds);

}  // namespace client
