// The scene between two snapshots, and a moment beyond the newest: pure functions.
//
// Positions follow the cubic Hermite curve through both ends with their velocities, which uniformly
// accelerated motion fits exactly; orientations turn at an even rate on the shortest way.
#pragma once

#include "wire/snapshot.h"

namespace client {

// A pose that jumped (a new serve) is not drawn through the air: faster than this it stays at the
// earlier one until the later is reached. Twice the fastest shot of a real table [m/s].
inline constexpr double kJumpSpeed = 40.0;

// share 0..1 of the way from a to b, which lie span_s apart. Precondition: span_s > 0.
wire::PoseVelocity interpolate(const wire::PoseVelocity& a, const wire::PoseVelocity& b,
                               double share, double span_s);
// What counts (score, screen, status) is as in a until b is reached.
wire::Snapshot interpolate(const wire::Snapshot& a, const wire::Snapshot& b, double share,
                           double span_s);

// Straight on with the velocities of `last`; seconds >= 0.
wire::PoseVelocity extrapolate(const wire::PoseVelocity& last, double seconds);
wire::Snapshot extrapolate(const wire::Snapshot& last, double seconds);

}  // namespace client
