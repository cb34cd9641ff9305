// Copies bodies to their states in the sub-stepped solver and back.
//
// A body without contact slots falls freely and is integrated here, in double precision. Its
// displacement equals that of n sub-steps h = dt / n of semi-implicit Euler:
//   dt v + a dt^2 (n + 1) / (2 n)
#include "world/body_states.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solve/state_vector.h"
#include "world/free_rotation.h"
#include "world/precession.h"
#include "world/solver_limits.h"
#include "world/validate.h"

namespace vp {
namespace {

// A state's displacement restarts at zero beyond kMaxDisplacement [length units] plus kFarSteps
// more steps of motion, so that single precision resolves small steps. It also restarts beyond
// kMaxRotation [rad], since rotations are added as vectors.
constexpr float kMaxDisplacement = 0.0625f, kFarSteps = 8.0f, kMaxRotation = 0.25f;

// A body that will deviate by more than this many of its half extents within the step from the
// motion by which its contacts were searched for has them searched for again. Up to about that much
// it may overlap what it is thrown at. A smaller fraction finds more and costs more.
constexpr double kDeviation = 0.2;

// The nearest rotation to a matrix with accumulated rounding errors: one step of Newton's method,
//   M (3 - M^T M) / 2,
// which unlike Gram-Schmidt adds no rotation.
Mat3 orthonormalized_by_newton(const Mat3& M) {
  const Vec3 &x = M.cx, &y = M.cy, &z = M.cz;
  const double xy = 0.5 * dot(x, y), yz = 0.5 * dot(y, z), zx = 0.5 * dot(z, x);
  return {(1.5 - 0.5 * dot(x, x)) * x - xy * y - zx * z,
          (1.5 - 0.5 * dot(y, y)) * y - xy * x - yz * z,
          (1.5 - 0.5 * dot(z, z)) * z - zx * x - yz * y};
}

Mat3 rotated_approximately(const Mat3& R, const Vec3& t) {
  const double tt = dot(t, t);
  if (tt > 1e-3) return orthonormalized(Exp(t).matrix() * R);
  const double s = 1.0 - tt * (1.0 / 6.0 - tt * (1.0 / 120.0 - tt * (1.0 / 5040.0)));
  const double c = 0.5 - tt * (1.0 / 24.0 - tt * (1.0 / 720.0));
  const Vec3 st = s * t, ct = c * t;
  const double xy = ct.x * t.y, yz = ct.y * t.z, zx = ct.z * t.x, rest = 1.0 - c * tt;
  return Mat3{{rest + ct.x * t.x, xy + st.z, zx - st.y},
              {xy - st.z, rest + ct.y * t.y, yz + st.x},
              {zx + st.y, yz - st.x, rest + ct.z * t.z}} *
         R;
}

// Rounding errors accumulate over thousands of steps. Two of the six orthonormality errors suffice
// to detect it.
bool needs_orthonormalizing(const Mat3& R) {
  constexpr double kMaxOrthonormalError = 1e-13;
  return std::fabs(dot(R.cx, R.cx) - 1.0) + std::fabs(dot(R.cy, R.cz)) > kMaxOrthonormalError;
}

// Relative to w: a smaller change in a step is lost in single precision.
constexpr double kSmallestChange = 1e-9;

// The angular acceleration that changes w over dt as torque-free rotation does in the body frame.
// The solver applies it at the orientation at the start of the step, so the energy is conserved
// there.
Vec3 gyroscopic_acceleration(const Body& body, double dt) {
  if (body.isotropic || hardly_rotates(body.w, dt)) return {};
  const Mat3& R = body.T.rotation();
  const Vec3 w = transposed_times(R, body.w);
  const Vec3 change = body.inverse_central * cross(body.central * w, w);
  if (dt * dt * dot(change, change) <= kSmallestChange * kSmallestChange * dot(w, w)) return {};
  const FreeRotation rotation = free_rotation(body.central, body.inverse_central, w, dt);
  return R * ((1.0 / dt) * (rotation.w - w));
}

}  // namespace

Rotated rotated_freely(const Body& body, double h, const Vec3& more_w) {
  const Mat3& R = body.T.rotation();
  const Vec3 w = transposed_times(R, body.w), L = R * (body.central * w);
  const Vec3 mean = more_w == Vec3{} ? w : transposed_times(R, body.w + more_w);
  const FreeRotation rotation = free_rotation(body.central, body.inverse_central, mean, h);
  Mat3 next = R * from_quaternion(rotation.q);
  next = orthonormalized_by_newton(next);
  // Angular momentum in the world frame is conserved to rounding.
  return {next, next * (body.inverse_central * transposed_times(next, L))};
}

// Relative: the energies of a body that bounced, by w at both orientations, up to which w is scaled
// to that of the bounce. At larger differences that would feed energy from one bounce to the next.
constexpr double kSameEnergy = 0.03;

Vec3 rate_at(const Body& body, const Mat3& R) {
  const Mat3& before = body.T.rotation();
  const Vec3 was = transposed_times(before, body.w), is = transposed_times(R, body.w);
  const double energy_was = dot(was, body.central * was), energy = dot(is, body.central * is);
  if (body.bounced && energy > 0.0 && std::fabs(energy_was - energy) <= kSameEnergy * energy)
    return std::sqrt(energy_was / energy) * body.w;
  return body.bounced || energy > energy_was ? R * was : body.w;
}

// R after a small rotation by the vector t: Rodrigues' formula with coefficients to sixth order,
// exact to rounding for the rotations of a step. Larger rotations use the exponential map.
Mat3 rotated(const Mat3& R, const Vec3& t) {
  return orthonormalized_by_newton(rotated_approximately(R, t));
}

bool BodyStates::load(Body& body, std::uint32_t index) const {
  body.untouched = body.shortened = body.bounced = body.precesses = body.is_top = false;
  solve::BodyState& state = states[index + 1];
  const bool pushed = body.motion == Motion::dynamic;
  put(state.velocity, body.v);
  put(state.velocity + 3, body.w);
  state.velocity[solve::kInverseMass] = pushed ? static_cast<float>(body.inverse_mass) : 0.0f;
  state.velocity[solve::kFalls] =
      pushed && !body.supported && body.first_joint == kNone ? 1.0f : 0.0f;
  state.inertia[solve::kKeepLinear] = state.inertia[solve::kKeepAngular] = 1.0f;
  if (pushed && (body.linear_damping > 0.0 || body.angular_damping > 0.0)) {
    const double h = dt / sub_steps;
    state.inertia[solve::kKeepLinear] = static_cast<float>(1.0 / (1.0 + h * body.linear_damping));
    state.inertia[solve::kKeepAngular] = static_cast<float>(1.0 / (1.0 + h * body.angular_damping));
  }
  state.displacement[solve::kSupported] = 0.0f;
  state.displacement[solve::kFractionMinusOne] = 0.0f;
  if (pushed && body.contact_slots > kMaxUnscaledContacts)
    state.displacement[solve::kFractionMinusOne] =
        static_cast<float>(kMaxUnscaledContacts / static_cast<double>(body.contact_slots) - 1.0);
  const float* displacement = state.displacement;
  Vec3 gyroscopic{};
  if (!pushed) {
    std::fill(std::begin(state.rate), std::end(state.rate), 0.0f);
    std::fill_n(state.inertia, 6, 0.0f);
  } else {
    const Sym3 I =
        body.isotropic ? body.inverse_central : rotated(body.T.rotation(), body.inverse_central);
    const double inertia[6] = {I.xx, I.yy, I.zz, I.xy, I.yz, I.zx};
    for (int i = 0; i < 6; ++i) state.inertia[i] = static_cast<float>(inertia[i]);
    const Velocity a = loads.acceleration(body, desc.gravity);
    put(state.rate, a.v);
    gyroscopic = gyroscopic_acceleration(body, dt);
    const double weight = std::fabs(body.gravity_scale) * norm(desc.gravity);
    body.precesses = precesses(body, gyroscopic, weight, dt, sub_steps);
    body.is_top = body.precesses && is_top(body, weight, dt);
    const Vec3 torqued = loads.is_torqued(body) ? a.w : Vec3{};
    put(state.rate + 3, body.precesses ? torqued : gyroscopic + torqued);
  }
  std::copy_n(displacement, 8, start_displacements[index].displacement);
  note_searched(index);
  set_search_limits(body, index, gyroscopic);
  const float* v = state.velocity;
  const float speed = std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])});
  const float far = kMaxDisplacement * static_cast<float>(desc.length_unit) +
                    kFarSteps * static_cast<float>(dt) * speed;
  const auto beyond = [displacement](int first, float limit) {
    return std::any_of(displacement + first, displacement + first + 3,
                       [limit](float x) { return !(std::fabs(x) <= limit); });  // true also for NaN
  };
  return beyond(0, far) || beyond(3, kMaxRotation);
}

bool BodyStates::wobbles(const Body& body, std::uint32_t index) const {
  constexpr double kMinSum = 0.02, kMinRate = 1e-3, kMaxAngle = 1.0;  // [rad], [rad/s], [rad]
  const Vec3 sum = vector_of(states[index + 1].displacement + 3);
  const double size = norm(sum), rate = norm(body.w);
  return size > kMinSum && rate > kMinRate &&
         dot(sum, body.w) < (1.0 - 0.5 * kMaxAngle * kMaxAngle) * size * rate;
}

void BodyStates::note_bounce(Body& body, std::uint32_t index) const {
  body.bounced = true;
  put(states[index + 1].rate + 3,
      loads.is_torqued(body) ? loads.acceleration(body, desc.gravity).w : Vec3{});
}

void BodyStates::set_acceleration(std::uint32_t index, const Velocity& change) const {
  put(states[index + 1].rate, (1.0 / dt) * change.v);
  put(states[index + 1].rate + 3, (1.0 / dt) * change.w);
}
// A sub-step adds its part of the change before it moves: n sub-steps move by the mean velocity if
// they start with it less (n + 1) / (2 n) of the change.
void BodyStates::start_acceleration(std::uint32_t index) const {
  solve::BodyState& state = states[index + 1];
  const auto time = static_cast<float>(0.5 * dt * (1.0 + 1.0 / sub_steps));
  for (int i = 0; i < 6; ++i) state.velocity[i] -= time * state.rate[i];
}

// What acceleration by forces moves it, it may deviate in addition: the margins allow for that.
void BodyStates::set_search_limits(const Body& body, std::uint32_t index,
                                   const Vec3& gyroscopic) const {
  solve::SearchedMotion& motion = searched[index];
  motion.distance = motion.angle = std::numeric_limits<float>::max();
  if (body.motion != Motion::dynamic || body.first_collider == kNone) return;
  const float* rate = states[index + 1].rate;
  const auto by_forces = [&](int first) {
    const float largest =
        std::max({std::fabs(rate[first]), std::fabs(rate[first + 1]), std::fabs(rate[first + 2])});
    return static_cast<float>(0.25 * dt * dt) * largest;
  };
  motion.distance = static_cast<float>(kDeviation * body.min_size) + by_forces(0);
  // A sphere about the centre of mass may rotate as it likes.
  if (body.bounding_radius <= body.min_size * (1.0 + 1e-9)) return;
  motion.angle =
      static_cast<float>(kDeviation * body.min_size / body.bounding_radius) + by_forces(3);
  if (body.precesses) motion.angle += static_cast<float>(0.25 * dt * dt * norm(gyroscopic));
}

void BodyStates::note_searched(std::uint32_t index) const {
  std::copy_n(states[index + 1].velocity, 6, searched[index].velocity);
}

void BodyStates::copy_to_body(Body& body, std::uint32_t index) const {
  const solve::BodyState& state = states[index + 1];
  const float* start = start_displacements[index].displacement;
  const Vec3 x = reference_point(body) + vector_of(state.displacement) - vector_of(start);
  const Vec3 rotation = vector_of(state.displacement + 3) - vector_of(start + 3);
  body.v = vector_of(state.velocity);
  body.w = vector_of(state.velocity + 3);
  set_pose(body, x, rotated(body.T.rotation(), rotation));
}

// Whether contacts and joints left its rotation unchanged, though it has contact slots. If so, it
// rotates freely, in double precision, and the state's rotation is set to that.
bool BodyStates::leave_untouched(Body& body, std::uint32_t index) const {
  solve::BodyState& state = states[index + 1];
  if (!body.tumbles() || body.first_joint != kNone || body.on_link || body.shortened) return false;
  if (loads.is_torqued(body)) return false;
  if (hardly_rotates(body.w, dt)) return false;
  const float h = static_cast<float>(dt / sub_steps);
  float w[3];
  put(w, body.w);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < sub_steps; ++k) w[i] += h * state.rate[3 + i];
    if (w[i] != state.velocity[3 + i]) return false;
  }
  const Mat3& R = body.T.rotation();
  const FreeRotation rotation =
      free_rotation(body.central, body.inverse_central, transposed_times(R, body.w), dt);
  put(state.displacement + 3,
      vector_of(start_displacements[index].displacement + 3) + R * mean_rotation(rotation));
  return body.untouched = true;
}

bool BodyStates::settle(Body& body, std::uint32_t index, Velocity& more) const {
  solve::BodyState& state = states[index + 1];
  body.supported = state.displacement[solve::kSupported] > 0.0f;
  more = {};
  if (!body.is_solver_driven()) {
    const double half = 0.5 * dt * (1.0 + 1.0 / sub_steps);
    const Vec3 v = body.v, w = body.w;
    const Velocity a = loads.acceleration(body, desc.gravity);
    const bool torqued = loads.is_torqued(body);
    body.v = (v + dt * a.v) * (1.0 / (1.0 + dt * body.linear_damping));
    if (torqued) body.w += dt * a.w;
    body.w *= 1.0 / (1.0 + dt * body.angular_damping);
    more.v = v + half * a.v - body.v;
    if (torqued) more.w = w + half * a.w - body.w;
    return true;
  }
  const float* start = start_displacements[index].displacement;
  body.v = vector_of(state.velocity);
  const double per_step = 1.0 / dt;
  more.v = per_step * (vector_of(state.displacement) - vector_of(start)) - body.v;
  if (!leave_untouched(body, index)) {
    body.w = vector_of(state.velocity + 3);
    more.w = per_step * (vector_of(state.displacement + 3) - vector_of(start + 3)) - body.w;
  }
  if (in_range(body.v) && in_range(body.w) && in_range(more.v) && in_range(more.w)) return true;
  body.v = body.w = {};
  more = {};
  return false;
}

bool BodyStates::advance(Body& body, std::uint32_t index) const {
  const solve::BodyState& state = states[index + 1];
  const float* start = start_displacements[index].displacement;
  const Vec3 v = vector_of(state.velocity), w = vector_of(state.velocity + 3);
  const Vec3 displacement = vector_of(state.displacement) - vector_of(start),
             rotation = vector_of(state.displacement + 3) - vector_of(start + 3);
  const Vec3 x = body.T * body.centre + displacement;
  if (!in_range(v) || !in_range(w) || !in_range(x) || !in_range(rotation)) return false;
  body.supported = state.displacement[solve::kSupported] > 0.0f;
  body.v = v;
  Mat3 R;
  if (leave_untouched(body, index)) {
    const Rotated free = rotated_freely(body, dt);
    R = free.R;
    body.w = free.w;
  } else {
    R = rotated_approximately(body.T.rotation(), rotation);
    if (needs_orthonormalizing(R)) R = orthonormalized_by_newton(R);
    body.w = w;
    if (!body.isotropic && !body.precesses && !hardly_rotates(w, dt)) body.w = rate_at(body, R);
  }
  body.T = SE3(R, x - R * body.centre);
  body.moved();
  return true;
}

}  // namespace vp
