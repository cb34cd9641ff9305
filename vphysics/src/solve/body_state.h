// The state of a body in the sub-stepped solver: two cache lines.
//
// Warm starts and iterations read only the first line. Sub-steps and the restitution pass start
// from the second. World axes, about the centre of mass. The world writes a state before a step
// (load), the passes write it during the step, and the world reads it back afterwards. State 0 is
// the world itself: nothing moves it, and everything fixed shares it.
#pragma once

#include <cstdint>

namespace vphysics_solver {

struct alignas(64) BodyState {
  // v of the centre of mass [m/s], w [rad/s]; the inverse mass; 1 if nothing supported the body in
  // the last step, else 0 (for the restitution pass).
  float velocity[8];
  // Displacement of the centre of mass since the state was last rebased [m]; rotation since then,
  // the sum of small rotation vectors [rad]; 1 if something supported the body in this step, else
  // 0; the fraction of the maximum bias velocity that each of its contacts may use, minus 1: 0
  // unless the body has many contacts.
  float displacement[8];
  // Inverse rotational inertia xx yy zz xy yz zx; the fractions of v and of w that damping leaves
  // per sub-step.
  float inertia[8];
  // Contribution of the forces: acceleration [m/s^2], angular acceleration [rad/s^2]; then 0, 0.
  float rate[8];
};
// A copy of the displacements of a state, from the start of the step.
struct alignas(32) StartDisplacement {
  float displacement[8] = {};
};
// How far bounces have moved a state in the present sub-step (restitution_pass.h), in the layout of
// its displacement. Zero between sub-steps.
struct alignas(32) BounceShift {
  float displacement[8] = {};
};
// Rotational inertia of a body that precesses and its inverse, at the start of the step, world
// axes: xx yy zz xy yz zx. In a unit of about its own size, so that products stay in the range of
// numbers; inverse[6] is the inverse of that unit [1/(kg m^2)].
struct alignas(64) BodyInertia {
  float inertia[8] = {}, inverse[8] = {};
};
inline constexpr int kInverseMass = 6, kFalls = 7;           // in velocity
inline constexpr int kKeepLinear = 6, kKeepAngular = 7;      // in inertia
inline constexpr int kSupported = 6, kFractionMinusOne = 7;  // in displacement
static_assert(sizeof(BodyState) == 128);

inline constexpr std::uint32_t kWorldState = 0;

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h
}  // namespace vp::solve
