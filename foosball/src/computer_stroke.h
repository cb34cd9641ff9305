// The effect of a stroke on a ball on the field: when the foot meets it, and how it sends it off.
// In a team's frame (computer_sight.h).
//
// Fitted to the simulated table: strokes of 24 to 112 rad/s, balls from 25 mm behind to 45 mm ahead
// of the axis that roll at up to 0.5 m/s, the foot's edge up to 11 mm beside them, men hinged and
// on rods. The predicted slope of the ball is accurate to 0.01.
#pragma once

#include "computer_hand.h"
#include "foosball/table.h"

namespace foosball {

struct Foot {
  double half_width = 0.012, half_depth = 0.010;  // [m]
};
Foot foot_of(const CharacterBody& body);

// The meeting of a stroke and a ball.
struct Meeting {
  double time = 0.0;   // from now [s]
  double ahead = 0.0;  // of the ball, from the rod's axis [m]
  double y = 0.0;      // of the ball [m]
  double rate = 0.0;   // of the stroke [rad/s]
};

// The swing at which the front of a foot touches a ball at this distance ahead of the axis [rad].
double contact_swing(const TableSpec& table, const Foot& foot, double ahead);

// Time from the decision to strike to the contact, with the foot at rest at `from` [rad] [s].
double stroke_time(double from, double contact, const AxisLimits& stroke);

// True if the foot rises at the contact: the ball hops.
bool lifts_ball(const Foot& foot, const TableSpec& table, const Meeting& meeting);

// Speed of the ball after a stroke of this rate [m/s].
double stroke_speed(const Foot& foot, const TableSpec& table, const Meeting& meeting);

// Slope dy/dx of a ball that rolls along the rod at vy [m/s] after a stroke by the flat of a foot
// that does not slide.
double natural_slope(const Foot& foot, const TableSpec& table, const Meeting& meeting, double vy);

// Offset of the foot's centre beside the ball's that deflects it by this slope [m]. For the
// smallest slopes it is 0: the flat of the foot. For others the foot's edge meets the ball. Slopes
// beyond kSteepest are not possible.
double foot_offset(const Foot& foot, const TableSpec& table, const Meeting& meeting, double slope);
inline constexpr double kSteepest = 0.75;
// For a smaller deflection the flat of the foot meets the ball.
inline constexpr double kFlatSlope = 0.02;

}  // namespace foosball
