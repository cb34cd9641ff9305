// Figures tuned to playability, not to reality (paper, section 5.1). Each says what breaks if it
// changes.
#pragma once

#include "vphysics/shapes.h"

namespace foosball::tuning {

// --- surfaces (a pair takes the larger restitution, the geometric mean of the frictions) ---------

// Livelier than cloth: a ball kicked into the field hops. Much more, and it flies over the walls.
inline constexpr vp::Material kField{0.30, 0.30, 0.00015};
// Shots come back off the walls; nearer 1, a missed shot never calms down.
inline constexpr vp::Material kWall{0.20, 0.75, 0.0};
// The goal swallows: a scored ball stays in the box, so that everyone sees it lie there.
inline constexpr vp::Material kGoalBox{0.60, 0.0, 0.010};
// Takes the other's restitution. The friction gives a sliding foot its drag on the ball.
inline constexpr vp::Material kBall{0.50, 0.0, 0.0};

// Heavier than the earth's, so that a ball that hops comes down again on the field.
inline constexpr double kGravity = 14.0;  // [m/s^2]

// Midway between two rods lies a strip that no foot reaches. There the field falls towards the
// nearer rod, as if it sagged by half a millimetre: a ball that stops rolls on to where it can be
// played. Must exceed the rolling resistance, 0.09 m/s^2; a shot crosses the strip and feels
// nothing.
inline constexpr double kSagFrom = 0.050;         // from the rod's axis [m]
inline constexpr double kSagAcceleration = 0.25;  // [m/s^2]

// Where the ball is put in play, ahead of the rod's axis [m]. A foot's half depth, the ball's
// radius and some 6 mm of air at the rods that restart play.
inline constexpr double kRestartAhead = 0.034;
// At the midfield that serves. The measure: with equal players the server scores next in half of
// the cases. Further ahead and the opponent's midfield has the first shot; behind the men, the
// server.
inline constexpr double kServeAhead = -0.037;

// --- a strong hand on each rod -------------------------------------------------------------------

// The hand and handle move with the rod. More, and a foot is heavier than its ball by far but slow.
inline constexpr double kHandMass = 0.40;       // [kg]
inline constexpr double kHandInertia = 5.0e-4;  // [kg m^2]

// Both drives are critically damped at this frequency: lag under a hand that accelerates at a is
// a / omega^2, so 40 m/s^2 lags 0.6 mm. Higher gains nothing, the force is at its bound already.
inline constexpr double kDriveOmega = 250.0;  // [rad/s]
// The most a hand does: what a pinched ball feels, and what limits a stroke.
inline constexpr double kHandForce = 350.0;  // [N]
inline constexpr double kHandTorque = 14.0;  // [N m]
// No rod goes faster than this however far its target jumps; real rods reach 140 rad/s.
inline constexpr double kMaxSlideRate = 8.0;    // [m/s]
inline constexpr double kMaxAngleRate = 150.0;  // [rad/s]

}  // namespace foosball::tuning
