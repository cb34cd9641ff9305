// Copies bodies to their states in the sub-stepped solver and back, in one step.
#pragma once

#include <cstdint>
#include <span>

#include "solve/body_state.h"
#include "solve/passes.h"
#include "world/body.h"
#include "world/loads.h"

namespace vp {

struct BodyStates {
  std::span<solve::BodyState> states;  // state i + 1 is of body i
  std::span<solve::StartDisplacement>
      start_displacements;  // of each body: displacement of its state when the step began
  std::span<solve::SearchedMotion> searched;  // of each body
  const BodyLoads& loads;
  const WorldDesc& desc;
  double dt;
  int sub_steps;

  // Before the sub-steps. True if the state's displacement is so long that it must restart at zero.
  bool load(Body& body, std::uint32_t index) const;
  // Whether the body rotates across what its state's rotation has become, or back: it wobbles or
  // swings. The sum of rotation vectors of a wobble is not its rotation, which it leaves by half of
  // the area that it encloses. Then clearances do not go on.
  bool wobbles(const Body& body, std::uint32_t index) const;
  // In a sub-step in which it has bounced: the gyroscopic torque of the start of the step is not
  // that of its new velocity.
  void note_bounce(Body& body, std::uint32_t index) const;
  // Of a kinematic body whose velocity changes evenly over the sub-steps, by `change` in a step,
  // with the mean that it has. After load(); and when its contacts have been found, by that mean.
  void set_acceleration(std::uint32_t index, const Velocity& change) const;
  void start_acceleration(std::uint32_t index) const;
  // After the sub-steps: sets a dynamic body's velocities to those at the end of the step. more:
  // mean velocities over the step less these. False if they are out of range: the body stops.
  bool settle(Body& body, std::uint32_t index, Velocity& more) const;
  // The same and the pose, for a dynamic body moved by its state; false if it leaves the range.
  bool advance(Body& body, std::uint32_t index) const;
  // Between two sub-steps: sets pose and velocities to those of the state.
  void copy_to_body(Body& body, std::uint32_t index) const;
  // The contacts of the body have been searched for at its state's present velocity.
  void note_searched(std::uint32_t index) const;

 private:
  void set_search_limits(const Body& body, std::uint32_t index, const Vec3& gyroscopic) const;
  bool leave_untouched(Body& body, std::uint32_t index) const;
};

}  // namespace vp
