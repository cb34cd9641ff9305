// Shared by the integrators: their memory, the rates of a state, and the checks of their inputs.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "multibody/tree.h"
#include "vphysics/assert.h"
#include "vphysics/multibody/integrators.h"

namespace vp::detail {

// A rigid displacement x -> R x + d. R is a unit quaternion: its vector part u, its real part c.
// Unlike a matrix, it represents a small displacement with full relative precision.
template <class T>
struct Displacement {
  Vec3T<T> u;
  T c{1};
  Vec3T<T> d;
};

// A node's data in the variational step (integrators_variational.cpp).
template <class T>
struct VariationalNode {
  InertiaT<T> J;
  Displacement<T> D;
  dse3T<T> momentum;
  SE3T<T> link, joint;  // of a user joint: poses of its link and of its own frame
};

inline constexpr std::size_t kMaxStages = 7;

template <class T>
struct IntegratorWork {
  IntegratorWork(const ModelT<base_t<T>>& model, Arithmetic arithmetic)
      : data(model, arithmetic),
        q(static_cast<std::size_t>(model.coordinates())),
        v(static_cast<std::size_t>(model.velocities())),
        u(v.size()),
        tau(v.size()),
        scale(v.size()),
        rest(v.size()),
        S(v.size()),
        nodes(model.tree().nodes.size()) {
    u_rate.fill(std::vector<T>(v.size()));
    v_rate.fill(std::vector<T>(v.size()));
  }

  DataT<T> data;
  std::vector<T> q, v;  // of a stage
  std::vector<T> u;     // tangent vector to it, q = q0 [+] u
  std::vector<T> tau;
  std::array<std::vector<T>, kMaxStages> u_rate, v_rate;
  std::vector<T> scale;                   // magnitude of the coordinate of each velocity
  std::vector<T> rest;                    // zeros
  std::vector<se3T<T>> S;                 // columns, one for each velocity
  std::vector<VariationalNode<T>> nodes;  // one for each node
};

inline tl::unexpected<Error> invalid_argument(const char* call, const char* why) {
  return tl::make_unexpected(Error{Errc::invalid_argument, std::string(call) + ": " + why});
}
inline tl::unexpected<Error> not_converged(const char* call, const char* why) {
  return tl::make_unexpected(Error{Errc::not_converged, std::string(call) + ": " + why});
}

template <class B>
bool positive_and_finite(B x) {
  return x > B(0) && std::isfinite(x);
}

template <class T>
Expected<void> check_step(const char* call, const ModelT<base_t<T>>& model,
                          [[maybe_unused]] std::span<const T> q,
                          [[maybe_unused]] std::span<const T> v, const StepT<T>& step) {
  VP_ASSERT(q.size() == static_cast<std::size_t>(model.coordinates()));
  VP_ASSERT(v.size() == static_cast<std::size_t>(model.velocities()));
  if (!positive_and_finite(step.h)) {
    return invalid_argument(call, "the step h must be positive and finite, in seconds");
  }
  if (!std::isfinite(step.t)) return invalid_argument(call, "the time t must be finite");
  if (!step.forces.fits(static_cast<std::size_t>(model.velocities()))) {
    return invalid_argument(call, "constant forces must be as many as the model has velocities");
  }
  return {};
}

// Computes v' at a state.
template <class T>
Expected<void> acceleration(const ModelT<base_t<T>>& model, IntegratorWork<T>& work,
                            std::span<const T> q, std::span<const T> v, base_t<T> t,
                            const StepT<T>& step, std::span<T> a) {
  return forward_dynamics<T>(model, work.data, q, v, step.forces.at(q, v, t, work.tau), step.loads,
                             a);
}

// u' = J_r^-1(u) v for ball and free joints, v for all others. Returns false if u is a full
// revolution or more: J_r has no inverse there.
template <class T>
bool rate_on_group(const Tree<base_t<T>>& tree, std::span<const T> u, std::span<const T> v,
                   std::span<T> rate);

}  // namespace vp::detail
