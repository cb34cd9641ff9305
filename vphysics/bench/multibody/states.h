// Random states of a model, and the base's velocity as the peers write it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models.h"

namespace vp::bench {

// As Virtual Physics has them (vphysics/multibody/joint.h).
struct State {
  std::vector<double> q, v, tau, a;
};
std::vector<State> random_states(const BenchModel& model, int count, std::uint64_t seed);

// The pose of a free base.
SE3 base_pose(const State& state);

// How an engine writes the six velocities of a free base: in which order, in which axes.
//
// The map B(R) from our velocities (angular, linear; axes of the link) to the engine's is
// orthogonal, so forces go by B too, and B^T leads back. Accelerations are the rates of these
// numbers: where the linear velocity is written in the world's axes, its rate has R (w x v)
// besides.
struct BaseConvention {
  bool linear_first, angular_in_world, linear_in_world;
};
struct BaseMap {
  BaseConvention as;
  Mat3 R;
  Vec3 w, v;  // of the state, in the link's axes

  BaseMap(BaseConvention convention, const State& state);
  void to(std::span<double> x) const;                 // velocities or forces, in place
  void from(std::span<double> x) const;               // and back
  void acceleration_to(std::span<double> x) const;    // rates of velocities, in place
  void acceleration_from(std::span<double> x) const;  // and back
  void mass_from(std::span<double> M, int n) const;   // M <- B^T M B
};

}  // namespace vp::bench
