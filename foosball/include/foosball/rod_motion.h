// How a hand drives a rod: the bounded force, the rates and the stops, as pure functions. The
// simulated table drives its articulations with this force law (table_world.cpp), and a renderer
// predicts its own rods with it. A rod that touches nothing moves here as it does in the simulated
// world, within the tolerances below (rod_motion_test.cpp).
//
// Each rod has two independent axes: the slide along the table's y and the rotation about it.
// Threads: pure functions, no state.
#pragma once

#include "foosball/table.h"
#include "foosball/tuning.h"

namespace foosball {

// Where a hand wants a rod. A rod that is not live is held where it is.
struct RodTarget {
  double slide = 0.0;       // [m]
  double angle = 0.0;       // [rad], unbounded: full turns count
  double slide_rate = 0.0;  // [m/s]
  double angle_rate = 0.0;  // [rad/s]
  bool live = false;
  bool operator==(const RodTarget&) const = default;
};

// A hand has moved its rod where the target is off by so much: what a sensor's noise or a table
// that is leant on does not reach.
inline constexpr double kLeastHandSlide = 0.003;  // [m]
inline constexpr double kLeastHandTurn = 0.05;    // [rad]

// The slide of a row, and the angle of the hand that turns it: what a rod does.
struct RodState {
  double slide, angle, slide_rate, angle_rate;  // as simulated [m, rad, m/s, rad/s]
};

// A man's own angle about his shoulder. On a rod it is the rod's; a hinged man (Layout::paper) has
// the hand's angle but while something holds him.
struct ManState {
  double angle, angle_rate;  // [rad], [rad/s]
};

// A spring and damper with a bounded force:
// force = clamp(stiffness (position - q) + damping (velocity - v), +-max_force).
struct AxisDrive {
  double position;   // [m] | [rad]
  double velocity;   // [m/s] | [rad/s]
  double stiffness;  // [N/m] | [N m/rad]
  double damping;    // [N s/m] | [N m s/rad]
  double max_force;  // [N] | [N m]
  bool operator==(const AxisDrive&) const = default;
};

// What a hand can do at most with the men of a character: the lower of what the tuning allows every
// hand and of the character's own.
struct HandLimits {
  double force;                   // [N]
  double torque;                  // [N m]
  double frequency;               // of the critically damped drives [rad/s]
  double slide_rate, angle_rate;  // [m/s], [rad/s]
};
HandLimits hand_limits(const CharacterBody& body, const Tuning& tuning = {});

// What the drive moves, and with what.
struct RodInertia {
  HandLimits limits;
  double rod_and_men;     // without the hand [kg]
  double slide;           // with the hand [kg]
  double axial;           // of rod and men about the axis, without the hand [kg m^2]
  double turn;            // with the hand [kg m^2]
  double man, man_axial;  // of one man: mass [kg]; about the axis [kg m^2]
};
RodInertia rod_inertia(const TableSpec& table, const RodSpec& rod, const CharacterBody& body,
                       const Tuning& tuning = {});

// The drives of the axes for one kTick, from where the rod is now: each critically damped with the
// inertia that it moves. Precondition: target is finite.
AxisDrive slide_drive(const RodSpec& rod, const RodInertia& inertia, const RodState& now,
                      const RodTarget& target);
AxisDrive angle_drive(const RodInertia& inertia, double angle, const RodTarget& target);

// The drive of a hinged man: the hand's, towards that of the hand's turns which is nearest to him,
// so that he is never more than half a turn behind: a man who is held while the hand spins on slips
// and does not wind up.
AxisDrive man_drive(const RodInertia& inertia, double angle, double hand_angle,
                    const RodTarget& target);
// The whole turns that such a man is ahead of his hand [rad].
double turns_ahead(double angle, double hand_angle);

// One kTick of a rod that touches nothing but its stops. Precondition: target is finite.
RodState step_rod(const RodSpec& rod, const RodInertia& inertia, const RodState& now,
                  const RodTarget& target);

// Against the simulated rod, over any motion of the hand [m], [rad]; measured 1e-15.
inline constexpr double kRodSlideTolerance = 1e-9;
inline constexpr double kRodAngleTolerance = 1e-9;

}  // namespace foosball
