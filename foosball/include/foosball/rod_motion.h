// How a hand drives a rod: bounded force, rates and stops, as pure functions. The simulated table
// drives its articulations with this force law (table_world.cpp). A renderer predicts its own rods
// with it. A rod without contacts moves here as it does in the simulated world, within the
// tolerances below (rod_motion_test.cpp).
//
// Each rod has two independent axes: the slide along the table's y and the rotation about it.
// Threads: pure functions, no state.
#pragma once

#include "foosball/table.h"
#include "foosball/tuning.h"

namespace foosball {

// Target of a hand for a rod. A rod that is not live holds its position.
struct RodTarget {
  double slide = 0.0;       // [m]
  double angle = 0.0;       // [rad], unbounded: full turns count
  double slide_rate = 0.0;  // [m/s]
  double angle_rate = 0.0;  // [rad/s]
  bool live = false;
  bool operator==(const RodTarget&) const = default;
};

// Thresholds: a hand has moved its rod if the target changed by at least this much. Sensor noise
// and a table that somebody leans on stay below.
inline constexpr double kMinHandSlide = 0.003;  // [m]
inline constexpr double kMinHandTurn = 0.05;    // [rad]

// State of a rod: the slide of the row and the angle of the hand that rotates it.
struct RodState {
  double slide, angle, slide_rate, angle_rate;  // simulated values [m, rad, m/s, rad/s]
};

// A man's own angle about his shoulder. On a rod it equals the rod's. A hinged man (Layout::paper)
// follows the hand's angle unless something blocks him.
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

// Limits of a hand with the men of a character: the lower of the tuning's limit for every hand and
// the character's own.
struct HandLimits {
  double force;                   // [N]
  double torque;                  // [N m]
  double frequency;               // of the critically damped drives [rad/s]
  double slide_rate, angle_rate;  // [m/s], [rad/s]
};
HandLimits hand_limits(const CharacterBody& body, const Tuning& tuning = {});

// Inertias of a rod, and the limits of its drives.
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

// The drives of the axes for one kTick from the rod's current state. Each is critically damped for
// the inertia that it moves. Precondition: target is finite.
AxisDrive slide_drive(const RodSpec& rod, const RodInertia& inertia, const RodState& now,
                      const RodTarget& target);
AxisDrive angle_drive(const RodInertia& inertia, double angle, const RodTarget& target);

// The drive of a hinged man. It follows the hand's angle modulo full turns, at the equivalent angle
// nearest to the man's. So he is never more than half a turn behind: a blocked man slips instead of
// winding up while the hand spins.
AxisDrive man_drive(const RodInertia& inertia, double angle, double hand_angle,
                    const RodTarget& target);
// Difference in full turns between such a man and his hand [rad].
double turns_ahead(double angle, double hand_angle);

// One kTick of a rod that touches only its stops. Precondition: target is finite.
RodState step_rod(const RodSpec& rod, const RodInertia& inertia, const RodState& now,
                  const RodTarget& target);

// Bounds on the difference from the simulated rod, for any motion of the hand [m], [rad]; measured
// 1e-15.
inline constexpr double kRodSlideTolerance = 1e-9;
inline constexpr double kRodAngleTolerance = 1e-9;

}  // namespace foosball
