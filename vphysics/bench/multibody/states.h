// Random states of a model, and conversions to the peers' conventions for the base's velocity.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models.h"

namespace vp::bench {

// In the convention of Virtual Physics (vphysics/multibody/joint.h).
struct State {
  std::vector<double> q, v, tau, a;
};
std::vector<State> random_states(const BenchModel& model, int count, std::uint64_t seed);

// The pose of a free base.
SE3 base_pose(const State& state);

// An engine's convention for the six velocities of a free base: their order and their axes.
//
// The map B(R) from our velocities (angular, linear; axes of the link) to the engine's is
// orthogonal: B also maps forces, and B^T is the inverse. Accelerations are the rates of these
// numbers. If the linear velocity is in world axes, its rate contains the additional term
// R (w x v).
struct BaseConvention {
  bool linear_first, angular_in_world, linear_in_world;
};
struct BaseMap {
  BaseConvention as;
  Mat3 R;
  Vec3 w, v;  // of the state, in the link's axes

  BaseMap(BaseConvention convention, const State& state);
  void to(std::span<double> x) const;                 // velocities or forces, in place
  void from(std::span<double> x) const;               // the inverse
  void acceleration_to(std::span<double> x) const;    // rates of velocities, in place
  void acceleration_from(std::span<double> x) const;  // the inverse
  void mass_from(std::span<double> M, int n) const;   // M <- B^T M B
};

}  // namespace vp::bench
