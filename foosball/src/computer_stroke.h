// What a stroke does to a ball on the field: when the foot meets it, and how it sends it off. In a
// team's frame (computer_sight.h).
//
// Fitted to the simulated table: strokes of 24 to 112 rad/s, of balls 25 mm behind to 45 mm ahead
// of the axis that roll at up to 0.5 m/s, the foot's edge up to 11 mm beside them, men hinged and
// on rods. The slope of what is sent off comes out to 0.01 of what is said here.
#pragma once

#include "computer_hand.h"
#include "foosball/table.h"

namespace foosball {

struct Foot {
  double half_width = 0.012, half_depth = 0.010;  // [m]
};
Foot foot_of(const CharacterBody& body);

// A stroke that meets a ball.
struct Meeting {
  double time = 0.0;   // from now [s]
  double ahead = 0.0;  // of the rod's axis, the ball [m]
  double y = 0.0;      // of the ball [m]
  double rate = 0.0;   // of the stroke [rad/s]
};

// The swing at which the front of a foot meets a ball this far ahead of the axis [rad].
double contact_swing(const TableSpec& table, const Foot& foot, double ahead);

// From the decision to strike until the ball is met, the foot at rest at `from` [rad] [s].
double stroke_time(double from, double contact, const AxisLimits& stroke);

// Whether the foot is already rising when it meets the ball, which then hops.
bool lifts_ball(const Foot& foot, const TableSpec& table, const Meeting& meeting);

// Of the ball sent off by a stroke of this rate [m/s].
double stroke_speed(const Foot& foot, const TableSpec& table, const Meeting& meeting);

// The slope dy/dx at which the flat of a foot that does not slide sends off a ball that rolls along
// the rod at vy [m/s].
double natural_slope(const Foot& foot, const TableSpec& table, const Meeting& meeting, double vy);

// How far beside the ball's centre the foot's must be to turn it off by this slope [m]: nothing,
// the flat of the foot, for the smallest; else its edge meets the ball. Steeper than kSteepest is
// not reached.
double foot_offset(const Foot& foot, const TableSpec& table, const Meeting& meeting, double slope);
inline constexpr double kSteepest = 0.75;
// Turned off by less, the ball meets the flat of the foot.
inline constexpr double kFlatSlope = 0.02;

}  // namespace foosball
