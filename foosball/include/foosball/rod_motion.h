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
};

struct RodState {
  double slide, angle, slide_rate, angle_rate;  // as simulated [m, rad, m/s, rad/s]
};

// A spring and damper with a bounded force:
// force = clamp(stiffness (position - q) + damping (velocity - v), +-max_force).
struct AxisDrive {
  double position;   // [m] | [rad]
  double velocity;   // [m/s] | [rad/s]
  double stiffness;  // [N/m] | [N m/rad]
  double damping;    // [N s/m] | [N m s/rad]
  double max_force;  // [N] | [N m]
};

// The drive of both axes for one kTick, from where the rod is now. Precondition: target is finite.
struct RodDrive {
  AxisDrive slide, angle;
};

// What a hand can do at most with the men of a character.
struct HandLimits {
  double force;                   // [N]
  double torque;                  // [N m]
  double frequency;               // of the critically damped drives [rad/s]
  double slide_rate, angle_rate;  // [m/s], [rad/s]
};
// Precondition: 0 <= character < kCharacters.
HandLimits hand_limits(int character, const Tuning& tuning = {});

RodDrive rod_drive(const RodSpec& rod, const HandLimits& limits, const RodState& now,
                   const RodTarget& target);

// What the drive moves, and with what.
struct RodInertia {
  HandLimits limits;
  double rod_and_men;  // without the hand [kg]
  double slide;        // with the hand [kg]
  double axial;        // of rod and men about the axis, without the hand [kg m^2]
  double turn;         // with the hand [kg m^2]
};
// Precondition: 0 <= character < kCharacters.
RodInertia rod_inertia(const TableSpec& table, const RodSpec& rod, int character,
                       const Tuning& tuning = {});

// One kTick of a rod that touches nothing but its stops. Precondition: target is finite.
RodState step_rod(const RodSpec& rod, const RodInertia& inertia, const RodState& now,
                  const RodTarget& target);

// Against the simulated rod, over any motion of the hand [m], [rad]; measured 1e-15.
inline constexpr double kRodSlideTolerance = 1e-9;
inline constexpr double kRodAngleTolerance = 1e-9;

}  // namespace foosball
