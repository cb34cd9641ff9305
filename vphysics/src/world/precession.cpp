#include "world/precession.h"

#include <cmath>

#include "solve/passes.h"

namespace vp {
namespace {

// The rate of precession is that at which the gyroscopic torque turns w. With the torque of the
// start of the step a body loses the fraction rate^2 dt / 2 of its spin per second. Below this
// fraction [1/s] it does not count as precessing.
constexpr double kMinLoss = 1e-5;
// Product of the traces of the inertia and its inverse: at least 9. Single precision would lose the
// smaller moments of inertia of others.
constexpr double kMaxCondition = 1e5;
// In a sub-step [rad]: faster rotation is not resolved.
constexpr double kMaxRotation = 2.0;
// Of a body without joints: energy of rotation, in that of lifting it by its radius.
constexpr double kMinEnergy = 3.0;
// The same: how much its inertia may change in a step in world axes, relative to itself. It rotates
// about an axis of symmetry, or its contacts, with their inertias, would not follow it.
constexpr double kMaxChange = 0.1;

void put(float* out, const Sym3& I) {
  const double values[6] = {I.xx, I.yy, I.zz, I.xy, I.yz, I.zx};
  for (int i = 0; i < 6; ++i) out[i] = static_cast<float>(values[i]);
}

double trace(const Sym3& I) {
  return I.xx + I.yy + I.zz;
}

// The derivative of a body's inertia in world axes, relative to it [1/s]; in body axes.
double rate_of_change(const Sym3& I, const Vec3& w) {
  double change = 0.0, size = 0.0;
  for (const Vec3& e : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 column = I * e, rate = cross(w, column) - I * cross(w, e);
    change += dot(rate, rate);
    size += dot(column, column);
  }
  return std::sqrt(change / size);
}

}  // namespace

bool precesses(const Body& body, const Vec3& gyroscopic, double weight, double dt, int sub_steps) {
  if (!body.tumbles() || body.continuous || !body.is_solver_driven() || body.row_joints > 0)
    return false;
  if (trace(body.central) * trace(body.inverse_central) > kMaxCondition) return false;
  const double h = dt / sub_steps;
  if (!(h * h * dot(body.w, body.w) < kMaxRotation * kMaxRotation)) return false;
  if (!(0.5 * dt * dot(gyroscopic, gyroscopic) > kMinLoss * dot(body.w, body.w))) return false;
  return body.first_joint != kNone || is_top(body, weight, dt);
}

bool is_top(const Body& body, double weight, double dt) {
  if (!(weight > 0.0)) return false;
  const Vec3 w = transposed_times(body.T.rotation(), body.w);
  return 0.5 * dot(w, body.central * w) > kMinEnergy * body.mass * weight * body.bounding_radius &&
         dt * rate_of_change(body.central, w) < kMaxChange;
}

void Precession::reserve(std::size_t bodies) {
  bodies_.reserve(bodies);
  on_contacts_.reserve(bodies);
  inertias_.reserve(bodies);
}

void Precession::list(const Bodies& bodies, const Regions& regions, std::size_t count) {
  bodies_.clear();
  on_contacts_.clear();
  inertias_.clear();
  first_.assign(1, 0);
  for (std::size_t region = 0; region < count; ++region) {
    for (const std::uint32_t i : regions.awake_bodies_of(region)) {
      const Body& body = bodies[i];
      if (!body.precesses) continue;
      bodies_.push_back(i);
      if (body.is_top) on_contacts_.push_back(i);
      solve::BodyInertia& inertia = inertias_.emplace_back();
      const double unit = trace(body.central);
      put(inertia.inertia, (1.0 / unit) * rotated(body.T.rotation(), body.central));
      put(inertia.inverse, unit * rotated(body.T.rotation(), body.inverse_central));
      inertia.inverse[6] = static_cast<float>(1.0 / unit);
    }
    first_.push_back(bodies_.size());
  }
}

void Precession::rotate(std::size_t region, std::span<solve::BodyState> states,
                        std::span<const solve::StartDisplacement> start_displacements,
                        std::span<solve::VelocityChange> before, double h) const {
  const std::span<const std::uint32_t> some = in(region);
  if (some.empty()) return;
  const auto add = [&](float sign) {
    for (const std::uint32_t i : some) {
      for (int k = 3; k < 6; ++k) before[i].velocity[k] += sign * states[i + 1].velocity[k];
    }
  };
  add(-1.0f);
  solve::joint_passes().precess(states.data(), start_displacements.data(), some.data(), some.size(),
                                inertias_.data() + first_[region], static_cast<float>(h));
  add(1.0f);
}

}  // namespace vp
