// The passes over blocks of joints, W lanes at a time. joint_block.h states the equations.
//
// A sub-step prepares (current poses, K and its factor), warm starts, and iterates with bias
// velocities. After the bodies have moved, it prepares once more and relaxes.
#pragma once

#include <algorithm>

#include "solve/joint_angles.h"
#include "solve/joint_lanes.h"

namespace vp::solve {

// Bounded rows are few. Their sweeps work on the Schur complement and do not access the bodies.
inline constexpr int kBoundedSweeps = 4;
// A sweep that changes no impulse by more than this fraction is the last.
inline constexpr float kBoundedConverged = 1e-6f;
// A drive's spring softer than this, in (sub-steps times natural frequency)^2, is integrated
// without gain or loss of energy; a stiffer one increasingly implicitly. Sixteen such springs on
// one body are still stable: the limit is 4.
inline constexpr float kExplicit = 0.25f;
// The stiffest spring of a drive, in the same unit: as stiff as a locked row. The iterations of a
// sub-step do not solve a stiffer one where several act in series, and it would throw the bodies.
inline constexpr float kStiffest = static_cast<float>(kJointBias / kJointLoss);
// A pivot below this fraction of its row's own K belongs to a row that depends on other rows.
inline constexpr float kDependent = 1e-6f;
inline constexpr float kMinResponse = 1e-30f;  // the smallest pivot that is inverted
// The bias of a hard row is clamped to this many times its maximum bias velocity. The clamp limits
// the steady load of an error; larger loads pull the joint open. Without it, rows that contradict
// one another would build up a load that throws their bodies about.
inline constexpr float kStrongest = 2.0f;
// In sub-steps shorter than a fifth of this [s] the maximum bias velocity grows: errors up to this
// time times that velocity are corrected at the full rate, since they may be rounding errors of
// single precision.
inline constexpr float kBriefly = 3.3e-4f;
inline constexpr float kJointConverged =
    1e-4f;  // as a fraction of the load: a smaller change by an iteration counts as converged

// --- preparation ---------------------------------------------------------------------------------

// Computes arms and separation of the point, and axes and coordinates of the rows, at the current
// poses. `separation` is the residual of the point's rows.
template <int W, class B, int kRows, int kLocked>
void evaluate_lanes(JointLanes<W, B, kRows, kLocked>& c, const StepMotion* motions, int at,
                    float max_bias_velocity, Vec3T<Lanes<W>>& separation) {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  const auto a =
      StepMotionLanes<W>::of([&](int i) { return motions[c.block().a.lane[at + i]].rotation; });
  const auto b =
      StepMotionLanes<W>::of([&](int i) { return motions[c.block().b.lane[at + i]].rotation; });
  if constexpr (B::kAxes) {
    PointPart& point = c.block().point;
    const V start_a = c.get(point.start_arm_a), start_b = c.get(point.start_arm_b);
    const V less_a = a.less(start_a), less_b = b.less(start_b);
    separation =
        c.get(point.start_separation) + (b.displacement - a.displacement) + (less_b - less_a);
    V arm_a = start_a + less_a + separation;
    if constexpr (B::kPointRows > 0) {
      // If the separation is larger than the bodies, the arm contains only a part of it: otherwise
      // it would act as a lever of arbitrary length. An impulse along the separation rotates the
      // body as before.
      const F pull = c.rate(0) * c.rate(0) * dot(separation, separation);
      const LaneMask<W> strong =
          pull > F(kStrongest * kStrongest * max_bias_velocity * max_bias_velocity);
      if (!none(strong)) {
        const F far = dot(separation, separation),
                near = dot(start_a, start_a) + dot(start_b, start_b);
        const LaneMask<W> too_far = both(strong, far > near);
        const F left = F(1.0f) - sqrt(near / select(too_far, far, F(1.0f)));
        arm_a = arm_a - select(too_far, left, F(0.0f)) * separation;
      }
    }
    c.put(point.arm_a, arm_a);
    c.put(point.arm_b, start_b + less_b);
  }
  if constexpr (B::kAxes && B::kOtherRows > 0) {
    AxesPart& axes = c.block().axes;
    const Frames<W> frames(c, axes, a, b);
    const Swing<W> swing(frames);
    // Accumulates full revolutions even if no row is about the twist: a later reader can resolve
    // only half a revolution per step.
    const auto counted_twist = [&] {
      constexpr float kRevolution = static_cast<float>(2.0 * kPi), kPass = 12582912.0f;
      const F twist = frames.twist(), turns = (c.get(axes.twist) - twist) * F(1.0f / kRevolution);
      const F counted = twist + F(kRevolution) * ((turns + F(kPass)) - F(kPass));
      c.put(axes.twist, counted);
      return counted;
    };
    if (!c.form().has(kTwist)) counted_twist();
    for (int i = 0; i < c.others(); ++i) {
      RowPart& row = c.block().rows[i];
      Field3& axis = c.block().jacobian[i];
      switch (c.form().slot[i]) {
        case 0:
        case 1:
        case 2: {
          const V n = c.form().slot[i] == 0   ? frames.ax
                      : c.form().slot[i] == 1 ? frames.ay
                                              : frames.az;
          c.put(row.residual, dot(n, separation));
          c.put(axis, n);
          break;
        }
        case kSwingX:
          c.put(row.residual, swing.x);
          c.put(axis, frames.world(swing.by_x));
          break;
        case kSwingY:
          c.put(row.residual, swing.y);
          c.put(axis, frames.world(swing.by_y));
          break;
        case kTwist:
          c.put(row.residual, i < c.form().locked ? frames.twist() : counted_twist());
          c.put(axis, frames.twist_axis());
          break;
        case kCone: {
          // The distance to the cone: (1 - f) / |grad f| with f^2 = (x / cone_x)^2 + (y /
          // cone_y)^2.
          const F ix = F(1.0f) / c.get(axes.cone_x), iy = F(1.0f) / c.get(axes.cone_y);
          const F sx = swing.x * ix, sy = swing.y * iy;
          const F f = sqrt(sx * sx + sy * sy);
          F gx = sx * ix, gy = sy * iy;
          const F g = sqrt(gx * gx + gy * gy);
          const LaneMask<W> swung = g > F(1e-9f);
          const F inverse = F(1.0f) / select(swung, g, F(1.0f));
          gx = select(swung, gx * inverse, F(1.0f));
          gy = select(swung, gy * inverse, F(0.0f));
          c.put(row.residual, select(swung, (F(1.0f) - f) * f * inverse,
                                     smaller(c.get(axes.cone_x), c.get(axes.cone_y))));
          c.put(axis, frames.world((-gx) * swing.by_x - gy * swing.by_y));
          break;
        }
      }
    }
  }
}

// Computes K without G, the lower triangle with the diagonal.
template <int W, class B, int kRows, int kLocked>
void find_response(const JointLanes<W, B, kRows, kLocked>& c, Lanes<W> (*K)[B::kAll]) {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  const auto I_a = c.get(c.block().inertia_a), I_b = c.get(c.block().inertia_b);
  const F m_a = c.get(c.block().mass_a), m_b = c.get(c.block().mass_b);
  constexpr int kPoint = B::kPointRows;
  V arm_a, arm_b;
  if constexpr (B::kAxes) {
    arm_a = c.get(c.block().point.arm_a);
    arm_b = c.get(c.block().point.arm_b);
  }
  if constexpr (kPoint > 0) {
    const F m = m_a + m_b, zero(0.0f), one(1.0f);
    for (int k = 0; k < 3; ++k) {
      const V e{k == 0 ? one : zero, k == 1 ? one : zero, k == 2 ? one : zero};
      const V u = m * e + cross(I_a * cross(arm_a, e), arm_a) + cross(I_b * cross(arm_b, e), arm_b);
      const F by[3] = {u.x, u.y, u.z};
      for (int i = k; i < 3; ++i) K[i][k] = by[i];
    }
  }
  for (int j = 0; j < c.others(); ++j) {
    if constexpr (B::kAxes && kPoint == 0) {
      const V n = c.get(c.block().jacobian[j]);
      const bool along = c.is_along(j);
      const V by_a = I_a * (along ? cross(arm_a, n) : n),
              by_b = I_b * (along ? cross(arm_b, n) : n);
      for (int i = j; i < c.others(); ++i) {
        const V of = c.get(c.block().jacobian[i]);
        F k = c.is_along(i) ? dot(cross(arm_a, of), by_a) + dot(cross(arm_b, of), by_b)
                            : dot(of, by_a + by_b);
        if (along && c.is_along(i)) k += (m_a + m_b) * dot(of, n);
        K[i][j] = k;
      }
    } else if constexpr (B::kAxes) {
      const V m = c.get(c.block().jacobian[j]), by_a = I_a * m, by_b = I_b * m;
      if constexpr (kPoint > 0) {
        const V u = cross(by_a, arm_a) + cross(by_b, arm_b);
        K[kPoint + j][0] = u.x;
        K[kPoint + j][1] = u.y;
        K[kPoint + j][2] = u.z;
      }
      const V turning = by_a + by_b;
      for (int i = j; i < c.others(); ++i) {
        K[kPoint + i][kPoint + j] = dot(c.get(c.block().jacobian[i]), turning);
      }
    } else {
      const TwelvePart& J = c.block().jacobian[j];
      const V v_a = m_a * c.get(J.linear_a), w_a = I_a * c.get(J.angular_a);
      const V v_b = m_b * c.get(J.linear_b), w_b = I_b * c.get(J.angular_b);
      for (int i = j; i < c.others(); ++i) {
        const TwelvePart& of = c.block().jacobian[i];
        K[kPoint + i][kPoint + j] = dot(c.get(of.linear_a), v_a) + dot(c.get(of.angular_a), w_a) +
                                    dot(c.get(of.linear_b), v_b) + dot(c.get(of.angular_b), w_b);
      }
    }
  }
}

// The maximum bias velocity of a locked row; unlimited for rows with user-defined softness.
template <int W, class B, int kRows, int kLocked>
Lanes<W> fastest_of(const JointLanes<W, B, kRows, kLocked>& c, int i, float bias) {
  using F = Lanes<W>;
  const bool linear = i < B::kPointRows || c.is_along(i - B::kPointRows);
  F fastest(linear ? bias : kMaxAngularBias);
  if constexpr (!B::kAxes) {
    const TwelvePart& J = c.block().jacobian[i];
    const auto square = [&](const Field3& f) { return dot(c.get(f), c.get(f)); };
    fastest = larger(F(bias) * sqrt(larger(square(J.linear_a), square(J.linear_b))),
                     F(kMaxAngularBias) * sqrt(larger(square(J.angular_a), square(J.angular_b))));
  }
  fastest = larger(fastest, c.rate(i) * (fastest * F(kBriefly)));
  return select(c.relaxes(i) > F(0.0f), fastest, F(kNoBound));
}

// Returns true if the error of a hard row is too large to be corrected at its full rate.
template <int W, class B, int kRows, int kLocked>
bool prepare_lanes(JointLanes<W, B, kRows, kLocked>& c, const StepMotion* motions, int at,
                   float max_bias_velocity) {
  using F = Lanes<W>;
  constexpr int kAll = B::kAll;
  Vec3T<F> separation;
  evaluate_lanes(c, motions, at, max_bias_velocity, separation);
  F K[kAll][kAll];
  find_response(c, K);
  B& block = c.block();
  const int n = c.count(), locked = c.locked();
  LaneMask<W> far = F(0.0f) > F(0.0f);
  F own[kAll];
  const F separations[3] = {separation.x, separation.y, separation.z};
  for (int i = 0; i < kAll && i < n; ++i) {
    own[i] = K[i][i];
    c.put(block.own[i], own[i]);
    if (i >= locked) continue;
    const F leak = c.loss(i) * own[i];
    const F residual = i < B::kPointRows ? separations[i < 3 ? i : 0]
                                         : c.get(block.rows[i - B::kPointRows].residual);
    const F fastest = fastest_of(c, i, max_bias_velocity), max_impulse = F(kStrongest) * fastest;
    const F bias = smaller(larger(c.rate(i) * residual, -max_impulse), max_impulse);
    c.put(block.bias[i], bias);
    far = either(far, abs(bias) > fastest);
    K[i][i] += leak;
  }
  // L below the diagonal of the locked columns; the rest becomes the Schur complement.
  for (int j = 0; j < kAll && j < locked; ++j) {
    const LaneMask<W> independent =
        both(K[j][j] > F(kDependent) * own[j], K[j][j] > F(kMinResponse));
    const F inverse = select(independent, F(1.0f) / K[j][j], F(0.0f));
    for (int i = j + 1; i < n; ++i) {
      const F l = K[i][j] * inverse;
      for (int k = j + 1; k <= i; ++k) K[i][k] -= l * K[k][j];
    }
    for (int i = j + 1; i < n; ++i) K[i][j] *= inverse;
    K[j][j] = inverse;
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) c.put(block.factor[factor_index(i, j)], K[i][j]);
  }
  return !none(far);
}

// --- force laws of bounded rows ------------------------------------------------------------------

template <class F>
F clamped(const F& x, const F& min_impulse, const F& max_impulse) {
  return smaller(larger(x, min_impulse), max_impulse);
}

// What does not change of a force law while the rows' impulses are found. At the speed u an impulse
// p becomes p - (m u + k + l p), within bounds.
template <int W>
struct ImpulseLaw {
  using F = Lanes<W>;
  F m{0.0f}, k{0.0f}, l{0.0f};
  F min_impulse{-kNoBound}, max_impulse{kNoBound};

  F next(const F& p, const F& u) const {
    return clamped(p - (m * u + k + l * p), min_impulse, max_impulse);
  }
};
template <int W>
ImpulseLaw<W> select(const LaneMask<W>& mask, const ImpulseLaw<W>& a, const ImpulseLaw<W>& b) {
  return {select(mask, a.m, b.m), select(mask, a.k, b.k), select(mask, a.l, b.l),
          select(mask, a.min_impulse, b.min_impulse), select(mask, a.max_impulse, b.max_impulse)};
}

// Of a drive. K: the change of the row's speed by a unit impulse. The force is that at the end of
// the sub-step, by its speed, from the error at its start. So the relaxation, after the bodies have
// moved, uses the error that the iterations have stored.
template <int W, class B, int kRows, int kLocked>
ImpulseLaw<W> drive_law(JointLanes<W, B, kRows, kLocked>& c, int i, const Lanes<W>& K, float h,
                        bool pushes) {
  using F = Lanes<W>;
  const BoundPart& bound = c.block().bounds[i];
  const F by_h_squared = F(h * h) * K, s0 = by_h_squared * c.get(bound.stiffness);
  // A softer spring with its damper keeps its time constant.
  const LaneMask<W> too_stiff = s0 > F(kStiffest);
  const F part = select(too_stiff, F(kStiffest) / select(too_stiff, s0, F(1.0f)), F(1.0f));
  const F stiffness = part * c.get(bound.stiffness), damping = part * c.get(bound.damping);
  const F s = by_h_squared * stiffness;
  const LaneMask<W> stiff = s > F(kExplicit);
  const F implicit = select(stiff, F(1.0f) - F(kExplicit) / select(stiff, s, F(1.0f)), F(0.0f));
  const F g = F(h) * damping + implicit * F(h * h) * stiffness;
  Field& stored = c.block().bias[B::kPointRows + i];
  if (pushes) c.put(stored, c.get(c.block().rows[i].residual) - c.get(bound.position));
  const F l = F(1.0f) / (F(1.0f) + g * K);
  const F force = stiffness * c.get(stored) - damping * c.get(bound.speed);
  return {g * l, F(h) * force * l, l, c.get(bound.min_impulse), c.get(bound.max_impulse)};
}

// Of a row that is locked within bounds. If the bounds allow one sign only, a separation may close.
template <int W, class B, int kRows, int kLocked>
ImpulseLaw<W> hold_law(const JointLanes<W, B, kRows, kLocked>& c, int i, const Lanes<W>& K, float h,
                       bool pushes) {
  using F = Lanes<W>;
  const F zero(0.0f), one(1.0f);
  const BoundPart& bound = c.block().bounds[i];
  const RowPart& row = c.block().rows[i];
  const F min_impulse = c.get(bound.min_impulse), max_impulse = c.get(bound.max_impulse),
          residual = c.get(row.residual), loss = c.get(row.loss);
  const LaneMask<W> open = either(both(min_impulse >= zero, residual > zero),
                                  both(max_impulse <= zero, residual < zero));
  const LaneMask<W> gives = K > zero;
  const F mass = select(gives, one / select(gives, K, one), zero);
  const F inverse = one / (one + loss);
  const F m = pushes ? inverse * mass : c.get(row.relaxes) * mass;
  const F bias = pushes ? c.get(row.rate) * residual : zero;
  const ImpulseLaw<W> law{
      select(open, mass, m), select(open, mass * (residual * F(1.0f / h)), m * bias),
      select(open, zero, pushes ? inverse * loss : zero), min_impulse, max_impulse};
  return select(gives, law, ImpulseLaw<W>{});
}

// Of the limit that is closer, with impulses and speeds that are positive away from it. A positive
// separation may close; a violated limit gets a bias velocity.
template <int W>
struct LimitLaw {
  using F = Lanes<W>;
  ImpulseLaw<W> law;
  F side{0.0f};  // 1: the lower limit; -1: the upper one; 0: there is none
  LaneMask<W> only_reduces = F(0.0f) > F(0.0f);

  // Of an impulse at that limit; `stop` in the row's direction, as in BoundPart.
  F change(const F& stop, const F& u) const {
    const F p = side * stop, next = law.next(p, side * u);
    return side * (select(only_reduces, smaller(next, p), next) - p);
  }
};
template <int W, class B, int kRows, int kLocked>
LimitLaw<W> limit_law(const JointLanes<W, B, kRows, kLocked>& c, int i, const Lanes<W>& K, float h,
                      float max_bias_velocity, bool pushes) {
  using F = Lanes<W>;
  const F zero(0.0f), one(1.0f);
  const BoundPart& bound = c.block().bounds[i];
  const RowPart& row = c.block().rows[i];
  const F residual = c.get(row.residual), loss = c.get(row.loss);
  const F below = residual - c.get(bound.lower), above = c.get(bound.upper) - residual;
  const LaneMask<W> at_lower = below <= above;
  const F separation = select(at_lower, below, above);
  const LaneMask<W> exists = separation < F(0.5f * kNoBound);
  const LaneMask<W> open = separation > zero;
  const LaneMask<W> gives = K > zero;
  const F mass = select(gives, one / select(gives, K, one), zero);
  const bool linear = !B::kAxes || c.is_along(i);
  const F bias =
      larger(c.get(row.rate) * separation, F(linear ? -max_bias_velocity : -kMaxAngularBias));
  const F inverse = one / (one + loss);
  const F m = pushes ? inverse * mass : c.get(row.relaxes) * mass;
  LimitLaw<W> limit;
  limit.law = {select(open, mass, m),
               select(open, mass * (separation * F(1.0f / h)), pushes ? m * bias : zero),
               select(open, zero, pushes ? inverse * loss : zero), zero, F(kNoBound)};
  limit.side = select(exists, select(at_lower, one, -one), zero);
  // The next sub-step handles an approach in it.
  if (!pushes) limit.only_reduces = open;
  return limit;
}

// --- iterations ----------------------------------------------------------------------------------

// Finds the impulses of the bounded rows. On entry, u has their speeds while the locked rows are
// satisfied, and `change` is zero. L: the factor of the block.
template <int W, class B, int kRows, int kLocked, class Factor>
void solve_bounded_rows(JointLanes<W, B, kRows, kLocked>& c, const LaneMask<W>& goes_on,
                        const Factor& L, Lanes<W>* u, Lanes<W>* change, float h,
                        float max_bias_velocity, bool pushes) {
  using F = Lanes<W>;
  B& block = c.block();
  const F zero(0.0f);
  const int n = c.count(), locked = c.locked();
  struct Row {
    ImpulseLaw<W> drive;  // or of a row locked within bounds
    LimitLaw<W> limit;
    F impulse, stop;
    bool is_driven, is_limited;
  };
  Row rows[kJointRows];
  LaneMask<W> moves = goes_on, moved = goes_on;
  const auto give = [&](int i, F& of, const F& wanted) {
    const F p = select(moves, wanted, zero);
    moved = either(moved, abs(p) > F(kBoundedConverged) * abs(of));
    of += p;
    change[i] += p;
    for (int j = locked; j < n; ++j) u[j] += (j < i ? L(i, j) : L(j, i)) * p;
  };
  for (int i = locked; i < n; ++i) {
    const int k = i - B::kPointRows;
    const BoundPart& bound = block.bounds[k];
    const F K = L(i, i);
    Row& row = rows[k];
    row.impulse = c.get(block.rows[k].impulse);
    row.stop = c.get(bound.stop);
    const LaneMask<W> holds = c.get(bound.holds) > zero,
                      drives = c.get(bound.max_impulse) > c.get(bound.min_impulse);
    row.is_driven = !none(either(holds, drives));
    if (row.is_driven) row.drive = select(drives, drive_law(c, k, K, h, pushes), ImpulseLaw<W>{});
    if (!none(holds)) row.drive = select(holds, hold_law(c, k, K, h, pushes), row.drive);
    row.limit = limit_law(c, k, K, h, max_bias_velocity, pushes);
    // The impulse of a limit that is no longer the closer one.
    const F stale = select(row.limit.side * row.stop > zero, zero, row.stop);
    if (!none(abs(stale) > zero)) give(i, row.stop, -stale);
    row.is_limited = !none(abs(row.limit.side) > zero);
  }
  const int sweeps = n > locked + 1 ? kBoundedSweeps : 1;
  for (int sweep = 0; sweep < sweeps && !none(moves); ++sweep) {
    moved = F(0.0f) > F(0.0f);
    for (int i = locked; i < n; ++i) {
      Row& row = rows[i - B::kPointRows];
      if (row.is_driven) give(i, row.impulse, row.drive.next(row.impulse, u[i]) - row.impulse);
      if (row.is_limited) give(i, row.stop, row.limit.change(row.stop, u[i]));
    }
    moves = both(moves, moved);  // each lane ends by itself
  }
  for (int i = locked; i < n; ++i) {
    const int k = i - B::kPointRows;
    c.put(block.rows[k].impulse, rows[k].impulse);
    c.put(block.bounds[k].stop, rows[k].stop);
  }
}

// On entry, u has the speed error of each locked row and the speed of each bounded one. Returns the
// changes of the impulses in `change`; zero in lanes outside goes_on.
template <int W, class B, int kRows, int kLocked>
void solve_rows(JointLanes<W, B, kRows, kLocked>& c, const LaneMask<W>& goes_on, Lanes<W>* u,
                Lanes<W>* change, float h, float max_bias_velocity, bool pushes) {
  using F = Lanes<W>;
  const F zero(0.0f);
  const int n = c.count(), locked = c.locked();
  const auto L = [&](int i, int j) { return c.get(c.block().factor[factor_index(i, j)]); };
  for (int j = 0; j < locked; ++j) {
    for (int i = j + 1; i < n; ++i) u[i] -= L(i, j) * u[j];
  }
  if constexpr (B::kOtherRows > 0) {
    for (int i = locked; i < n; ++i) change[i] = zero;
    if (n > locked) solve_bounded_rows(c, goes_on, L, u, change, h, max_bias_velocity, pushes);
  }
  for (int i = locked - 1; i >= 0; --i) {
    F x = -(L(i, i) * u[i]);
    for (int k = i + 1; k < n; ++k) x -= L(k, i) * change[k];
    change[i] = x;
  }
  for (int i = 0; i < locked; ++i) {
    change[i] = select(goes_on, change[i], zero);
    c.set_impulse(i, c.impulse(i) + change[i]);
  }
}

template <int W, class B, int kRows, int kLocked>
void warm_start_lanes(JointLanes<W, B, kRows, kLocked>& c) {
  Lanes<W> p[B::kAll];
  for (int i = 0; i < c.count(); ++i) p[i] = c.all_impulse(i);
  c.gather_velocities();
  c.apply_impulse(p);
  c.scatter_velocities();
}

// An iteration with bias velocities. Iterations after the first of a sub-step skip converged
// joints. kSomeFar: some joints of the region have errors too large to be corrected at their full
// rate.
template <bool kSomeFar, int W, class B, int kRows, int kLocked>
void solve_lanes(JointLanes<W, B, kRows, kLocked>& c, float h, float max_bias_velocity,
                 bool first) {
  using F = Lanes<W>;
  const F zero(0.0f), one(1.0f);
  B& block = c.block();
  const LaneMask<W> goes_on = first ? zero < one : c.get(block.active) > zero;
  if (!first && none(goes_on)) return;
  F u[B::kAll], change[B::kAll];
  c.gather_velocities();
  c.speeds(u);
  for (int i = 0; i < c.locked(); ++i) {
    const F bias = c.get(block.bias[i]);
    const F lost = (c.loss(i) * c.get(block.own[i])) * c.impulse(i);
    F target = bias + lost;
    if constexpr (kSomeFar) {
      // Clamps the bias so that its sum with the softness term is within the maximum bias velocity.
      // The softness term itself is not clamped.
      const F fastest = fastest_of(c, i, max_bias_velocity);
      const F max_impulse = larger(fastest - select(bias > zero, lost, -lost), zero);
      target = select(abs(bias) > fastest, clamped(bias, -max_impulse, max_impulse) + lost, target);
    }
    u[i] += target;
  }
  solve_rows(c, goes_on, u, change, h, max_bias_velocity, true);
  c.apply_impulse(change);
  c.scatter_velocities(goes_on);
  F moved = zero, load = zero;  // weighted by response: rows are forces or moments
  for (int i = 0; i < c.count(); ++i) {
    const F p = c.all_impulse(i), own = c.get(block.own[i]);
    moved += (change[i] * own) * change[i];  // squared impulses could underflow
    load += (p * own) * p;
  }
  const LaneMask<W> converged = moved <= F(kJointConverged * kJointConverged) * load;
  c.put(block.active, select(both(goes_on, !converged), one, zero));
}

// Removes the bias from the velocities, and accumulates the sub-step's force and torque.
template <int W, class B, int kRows, int kLocked>
void relax_lanes(JointLanes<W, B, kRows, kLocked>& c, float h) {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  F u[B::kAll], change[B::kAll];
  B& block = c.block();
  c.gather_velocities();
  c.speeds(u);
  for (int i = 0; i < c.locked(); ++i) u[i] *= c.relaxes(i);
  solve_rows(c, F(0.0f) < F(1.0f), u, change, h, 0.0f, false);
  c.apply_impulse(change);
  c.scatter_velocities();
  V force = c.get(block.force);
  if constexpr (B::kPointRows > 0) force += c.get(block.point.impulse);
  if constexpr (B::kOtherRows > 0) {
    V torque = c.get(block.torque);
    for (int i = 0; i < c.others(); ++i) {
      const F p = c.all_impulse(B::kPointRows + i);
      if constexpr (B::kAxes) {
        (c.is_along(i) ? force : torque) += p * c.get(block.jacobian[i]);
      } else {
        const V linear = c.get(block.jacobian[i].linear_b);
        force += p * linear;
        torque += p * (c.get(block.jacobian[i].angular_b) - cross(c.get(block.anchor), linear));
      }
    }
    c.put(block.torque, torque);
  }
  c.put(block.force, force);
}

}  // namespace vp::solve
