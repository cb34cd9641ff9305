// A body as the solver sees it: a row of two cache lines.
//
// The first line is all that warm starts and rounds read, the second what sub-steps and bounces
// begin with. World axes, about the centre of mass. Written by the world before a step (load) and
// by the passes; read back after it. Row 0 is the world itself: nothing moves it, and all that is
// fixed shares it.
#pragma once

#include <cstdint>

namespace vphysics_solver {

struct alignas(64) BodyRow {
  // v of the centre of mass [m/s], w [rad/s]; the inverse mass; 1 if nothing carried it in the last
  // step, 0 if something did, which matters to bounces.
  float velocity[8];
  // Way of the centre of mass since the row was last rebased [m], and its turning, the sum of small
  // rotation vectors [rad]; 1 if something carried it in this step, else 0; the
  // share of the fastest push that each of its contacts has, less 1: 0 unless they are many.
  float displacement[8];
  // Inverse rotational inertia xx yy zz xy yz zx; the shares of v and of w that damping leaves in a
  // sub-step.
  float inertia[8];
  // What the forces add: acceleration [m/s^2], angular acceleration [rad/s^2]; 0, 0.
  float rate[8];
};
inline constexpr int kInverseMass = 6, kFalls = 7;         // in velocity
inline constexpr int kKeepLinear = 6, kKeepAngular = 7;    // in inertia
inline constexpr int kCarried = 6, kFractionMinusOne = 7;  // in way
static_assert(sizeof(BodyRow) == 128);

inline constexpr std::uint32_t kWorldRow = 0;

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h
}  // namespace vp::solve
