//   spring   k (rest - q)
//   limit    max(0, k (lower - q) - d v) below the lower limit, and likewise above the upper limit
//   motor    k (position - q) + d (velocity - v), clamped to its maximum
#include "vphysics/multibody/joint_forces.h"

#include "multibody/instantiate.h"
#include "vphysics/assert.h"
#include "vphysics/lie/scalar.h"

namespace vp {
namespace detail {
namespace {

template <class T>
T at_most(const T& x, const T& max_value) {
  return select(x > max_value, max_value, select(x < -max_value, -max_value, x));
}

// `beyond` is the distance of the coordinate beyond the limit, rate its rate of increase.
template <class T>
T limit_force(const JointForces& f, const T& beyond, const T& rate) {
  const T resistance = T(static_cast<base_t<T>>(f.limit_stiffness)) * beyond +
                       T(static_cast<base_t<T>>(f.limit_damping)) * rate;
  return select(both(beyond > T(0), resistance > T(0)), resistance, T(0));
}

template <class T>
T passive_force(const JointForces& f, const T& q, const T& v) {
  using B = base_t<T>;
  T sum = T(static_cast<B>(f.stiffness)) * (T(static_cast<B>(f.rest)) - q);
  if (f.limit_stiffness == JointForces::kNever) return sum;
  if (f.lower > -JointForces::kNever) sum += limit_force<T>(f, T(static_cast<B>(f.lower)) - q, -v);
  if (f.upper < JointForces::kNever) sum -= limit_force<T>(f, q - T(static_cast<B>(f.upper)), v);
  return sum;
}

}  // namespace
}  // namespace detail

template <class T>
void joint_forces(const ModelT<base_t<T>>& model, std::span<const T> q, std::span<const T> v,
                  std::span<const MotorT<T>> motors, std::span<T> tau) {
  VP_ASSERT(q.size() == static_cast<std::size_t>(model.coordinates()));
  VP_ASSERT(v.size() == static_cast<std::size_t>(model.velocities()) && tau.size() == v.size());
  VP_ASSERT(motors.empty() || motors.size() == v.size());
  for (int l = 0; l < model.links(); ++l) {
    const LinkSpec& link = model.link(l);
    const auto first_q = static_cast<std::size_t>(model.first_coordinate(l));
    const auto first_v = static_cast<std::size_t>(model.first_velocity(l));
    const auto dofs = static_cast<std::size_t>(velocities_of(link.joint));
    const bool own = coordinates_of(link.joint) == velocities_of(link.joint);
    for (std::size_t k = 0; k < dofs; ++k) {
      const std::size_t i = first_v + k;
      const T x = own ? q[first_q + k] : T(0);
      const JointForces* f = link.forces.empty() ? nullptr : &link.forces[k];
      if (f != nullptr && own) tau[i] += detail::passive_force<T>(*f, x, v[i]);
      if (motors.empty()) continue;
      const MotorT<T>& m = motors[i];
      T force = m.damping * (m.velocity - v[i]);
      if (own) force += m.stiffness * (m.position - x);
      if (f != nullptr && f->motor_limit < JointForces::kNever) {
        force = detail::at_most(force, T(static_cast<base_t<T>>(f->motor_limit)));
      }
      tau[i] += detail::at_most(force, m.max_force);
    }
  }
}

#define VP_JOINT_FORCES(T)                                                                     \
  template void joint_forces(const ModelT<base_t<T>>&, std::span<const T>, std::span<const T>, \
                             std::span<const MotorT<T>>, std::span<T>);
VP_FOR_EACH_SCALAR(VP_JOINT_FORCES)

}  // namespace vp
