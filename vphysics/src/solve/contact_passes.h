// The passes over blocks of contacts, W lanes at a time.
//
// A sub-step h of the solver has these stages. Each runs over all colours before the next starts:
//
//   v += h a
//   restitution   contacts that touch within h and bounce do so now, in sequence
//   warm start    v += M^-1 J^T p          p: the impulses of the last sub-step
//   solve         soft: a bias velocity removes penetration, an approach may close a separation;
//                 iterations after the first skip contacts that the last one has hardly changed
//   x += h v
//   relax         the same without the bias velocity, so that no bias velocity remains
//
// One contact is solved as a block: its points interact through K (contact_block.h), and only the
// sum of their impulses is applied to the bodies.
//
// Sources: Catto, Soft Contact (Solver2D), 2024, for the order and the softness; Catto, Modeling
// and Solving Constraints, GDC 2009; Tonge, Solving Rigid Body Contacts, GDC 2012, for friction
// patches. Restitution: docs/decisions/0019.
#pragma once

#include "solve/block_lanes.h"
#include "solve/contact_block.h"
#include "solve/passes.h"

namespace vp::solve {

template <int W, int P>
using LanesOf = BlockLanes<W, ContactBlock<P>>;

// Data shared by the normal rows of a contact.
template <int W, int P>
struct Normals {
  using F = Lanes<W>;
  using V = Vec3T<F>;

  explicit Normals(const LanesOf<W, P>& c)
      : n(c.get(c.block().normal)),
        t(c.get(c.block().tangent)),
        b(cross(n, t)),
        d_n(cross(c.get(c.block().d), n)) {
    for (int i = 0; i < P; ++i) {
      arm_t[i] = c.get(c.block().arm[i].t);
      arm_b[i] = c.get(c.block().arm[i].b);
    }
  }
  // out_i = n . linear + (d x n) . rotation_b + arm . (rotation_b - rotation_a), for all points.
  void along(const V& linear, const V& rotation_a, const V& rotation_b, F* out) const {
    const F common = dot(n, linear) + dot(d_n, rotation_b);
    const V rotation = rotation_b - rotation_a;
    const F angular_t = dot(t, rotation), angular_about_b = dot(b, rotation);
    for (int i = 0; i < P; ++i) {
      out[i] = common + (arm_t[i] * angular_t + arm_b[i] * angular_about_b);
    }
  }
  void speeds(const LanesOf<W, P>& c, F* u) const { along(c.v_b - c.v_a, c.w_a, c.w_b, u); }
  void separations(const LanesOf<W, P>& c, F* s) const {
    along(c.x_b - c.x_a, c.rotation_a, c.rotation_b, s);
    for (int i = 0; i < P; ++i) s[i] += c.get(c.block().base[i]);
  }
  // Applies the changes of the points' impulses to the bodies.
  void apply_impulse(LanesOf<W, P>& c, const F* change) const {
    F sum = change[0], moment_t = change[0] * arm_t[0], moment_b = change[0] * arm_b[0];
    for (int i = 1; i < P; ++i) {
      sum += change[i];
      moment_t += change[i] * arm_t[i];
      moment_b += change[i] * arm_b[i];
    }
    const V moment = moment_t * t + moment_b * b;
    c.apply_linear(sum * n);
    c.apply_angular(moment, moment + sum * d_n);
  }

  V n, t, b, d_n;
  F arm_t[P], arm_b[P];
};

template <int W, int P>
Lanes<W> sum_of_impulses(const LanesOf<W, P>& c) {
  Lanes<W> sum = c.get(c.block().impulse[0]);
  for (int i = 1; i < P; ++i) sum += c.get(c.block().impulse[i]);
  return sum;
}

// Solves the points of one contact together. Each point stops its own speed u_i by an impulse p_i
// >= 0, given those of the others. With the masses m_i and the fractions s_i = m_i K_ii,
//   p_i' = p_i - m_i u_i - (1 - s_i) p_i,   u = u0 + K (p - p0)
// becomes, since p_i cancels,
//   p_i' = e_i - sum_{j != i} m_i K_ij p_j,  e_i = s_i p0_i - m_i u0_i + sum_{j != i} m_i K_ij p0_j
// whose chain of dependent operations is a third as long. With m_i = 0 a point keeps p0_i if s_i is
// 1, and gets 0 if s_i is 0.
template <int W, int P>
class Points {
 public:
  using F = Lanes<W>;

  Points(const LanesOf<W, P>& c, const F* mass, const F* fraction, const F* u0, const F* p0) {
    for (int i = 0; i < P; ++i) {
      F e = fraction[i] * p0[i] - mass[i] * u0[i];
      for (int j = 0; j < P; ++j) {
        if (j == i) continue;
        k_[i][j] = mass[i] * c.get(c.block().off_diagonal[pair_index(i, j)]);
        e += k_[i][j] * p0[j];
      }
      e_[i] = e;
    }
  }
  // The next impulse without the bound p >= 0.
  F target(int i, const F* p) const {
    F x = e_[i];
    for (int j = 1; j < P; ++j) {  // the most recently changed impulse comes last
      const int other = (i + j) % P;
      x -= k_[i][other] * p[other];
    }
    return x;
  }
  // Without impulses so far: the impulse if all points that act have the same one. With a start
  // from there what falls flat does not begin to rotate.
  F shared(int i, const F* acts) const {
    F sum(1.0f);
    for (int j = 0; j < P; ++j) {
      if (j != i) sum += acts[j] * k_[i][j];
    }
    return select(sum > F(0.0f), larger(e_[i] / larger(sum, F(0.25f)), F(0.0f)), F(0.0f));
  }
  // If no point has an impulse: m_i times the remaining approach speed.
  const F& approach_speed(int i) const { return e_[i]; }

 private:
  F e_[P], k_[P][P];
};

// Lanes that the restitution pass may skip. loaded: the lanes with a load.
template <int W>
LaneMask<W> neither_bounces_nor_comes_to_touch(const LaneMask<W>& loaded, const Lanes<W>& e) {
  return both(loaded, !(e > Lanes<W>(0.0f)));
}

// As a fraction of the load: later iterations skip a contact whose impulses an iteration has
// changed by less. Ten times this is enough for piles, but a wall then takes longer to come to
// rest.
inline constexpr float kConvergedForNow = 1e-4f;

// --- friction ------------------------------------------------------------------------------------

template <int W, int P>
struct Grip {
  using F = Lanes<W>;
  using V = Vec3T<F>;

  Grip(const LanesOf<W, P>& c, const Normals<W, P>& normals)
      : t(normals.t), b(normals.b), r_a(c.get(c.block().grip)), r_b(r_a + c.get(c.block().d)) {}
  V velocity(const LanesOf<W, P>& c) const {
    return c.v_b + cross(c.w_b, r_b) - c.v_a - cross(c.w_a, r_a);
  }
  V t, b, r_a, r_b;
};

// Updates two tangential impulses p at the slip velocity u, with |p| <= limit. Sticking: the
// full 2x2 block stops the slip. Sliding: one effective mass, since the block would rotate the
// impulse away from the slip direction.
template <int W, int P>
void grip_or_slide(const LanesOf<W, P>& c, const Lanes<W>* u, const Lanes<W>& limit, Lanes<W>* p) {
  using F = Lanes<W>;
  auto& block = c.block();
  const F q0 = p[0], q1 = p[1], xy = c.get(block.stick[1]);
  p[0] = q0 - (c.get(block.stick[0]) * u[0] + xy * u[1]);
  p[1] = q1 - (xy * u[0] + c.get(block.stick[2]) * u[1]);
  const auto slides = p[0] * p[0] + p[1] * p[1] > limit * limit;
  if (none(slides)) return;
  const F mass = c.get(block.slide);
  const F s0 = q0 - mass * u[0], s1 = q1 - mass * u[1];
  const F size = sqrt(s0 * s0 + s1 * s1);
  const F fraction = select(size > limit, limit / size, F(1.0f));
  p[0] = select(slides, fraction * s0, p[0]);
  p[1] = select(slides, fraction * s1, p[1]);
}

template <int W>
LaneMask<W> within(const Lanes<W>& x, const Lanes<W>& limit) {
  return abs(x) <= limit;
}
template <int W>
Lanes<W> clamped(const Lanes<W>& x, const Lanes<W>& limit) {
  return larger(-limit, smaller(x, limit));
}

// Changes only the lanes `acts`. Returns the lanes in which no impulse has changed by more than the
// fraction kConvergedForNow of the load.
template <int W, int P>
LaneMask<W> solve_friction(LanesOf<W, P>& c, const Normals<W, P>& normals,
                           const LaneMask<W>& acts) {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  auto& block = c.block();
  const F load = sum_of_impulses(c);
  const Grip<W, P> at(c, normals);
  const V& n = normals.n;
  const V slip = at.velocity(c);
  F u[2] = {dot(at.t, slip) - c.get(block.surface_speed[0]),
            dot(at.b, slip) - c.get(block.surface_speed[1])};
  const F q[2] = {c.get(block.tangent_impulse[0]), c.get(block.tangent_impulse[1])};
  F p[2] = {q[0], q[1]};
  grip_or_slide(c, u, c.get(block.friction) * load, p);
  p[0] = select(acts, p[0], q[0]);
  p[1] = select(acts, p[1], q[1]);
  c.put(block.tangent_impulse[0], p[0]);
  c.put(block.tangent_impulse[1], p[1]);
  const F enough = F(kConvergedForNow) * load;
  auto converged = both(within(p[0] - q[0], enough), within(p[1] - q[1], enough));
  const V force = (p[0] - q[0]) * at.t + (p[1] - q[1]) * at.b;

  const V spin = c.w_b - c.w_a;
  const F twist = c.get(block.twist_impulse);
  const F next = select(
      acts, clamped(twist - c.get(block.twist_mass) * dot(n, spin), c.get(block.twist_arm) * load),
      twist);
  c.put(block.twist_impulse, next);
  converged = both(converged, within(next - twist, c.get(block.twist_arm) * enough));
  V moment = (next - twist) * n;
  const F mass = c.get(block.roll_mass);
  if (!none(mass > F(0.0f))) {
    const F limit = c.get(block.roll_arm) * load;
    const F r0 = c.get(block.roll_impulse[0]), r1 = c.get(block.roll_impulse[1]);
    const F s0 = r0 - mass * dot(at.t, spin), s1 = r1 - mass * dot(at.b, spin);
    const F size = sqrt(s0 * s0 + s1 * s1);
    const F fraction = select(size > limit, limit / size, F(1.0f));
    const F e0 = select(acts, fraction * s0, r0), e1 = select(acts, fraction * s1, r1);
    c.put(block.roll_impulse[0], e0);
    c.put(block.roll_impulse[1], e1);
    const F lever = c.get(block.roll_arm);
    converged =
        both(converged, both(within(e0 - r0, lever * enough), within(e1 - r1, lever * enough)));
    moment += (e0 - r0) * at.t + (e1 - r1) * at.b;
  }
  c.apply_linear(force);
  c.apply_angular(cross(at.r_a, force) + moment, cross(at.r_b, force) + moment);
  return converged;
}

// --- the passes ----------------------------------------------------------------------------------

template <int W, int P>
void warm_start_lanes(LanesOf<W, P>& c) {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  auto& block = c.block();
  c.gather_velocities();
  const Normals<W, P> normals(c);
  F p[P];
  for (int i = 0; i < P; ++i) p[i] = c.get(block.impulse[i]);
  normals.apply_impulse(c, p);
  const Grip<W, P> at(c, normals);
  const V force = c.get(block.tangent_impulse[0]) * at.t + c.get(block.tangent_impulse[1]) * at.b;
  const V moment = c.get(block.twist_impulse) * normals.n + c.get(block.roll_impulse[0]) * at.t +
                   c.get(block.roll_impulse[1]) * at.b;
  c.apply_linear(force);
  c.apply_angular(cross(at.r_a, force) + moment, cross(at.r_b, force) + moment);
  c.scatter_velocities();
}

// The maximum number of sweeps over the points of one contact before the impulses are applied.
inline constexpr int kInnerSweeps = 4;
inline constexpr float kConverged = 1e-3f;       // change of a point, as a fraction of the load
inline constexpr float kLargestImpulse = 1e30f;  // [N s]

// first, again: the first iteration of a sub-step, and later ones; relax: without bias velocity.
enum class Pass { first, again, relax };

// A contact deeper than this many times its slid_limit is too deep for the solver. slid_limit is a
// hundredth of the smaller shape's half extent, so the limit is half of that half extent.
inline constexpr float kTooDeep = 50.0f;

template <int W, int P>
Lanes<W> deepest_of(const Lanes<W>* s) {
  Lanes<W> deepest = s[0];
  for (int i = 1; i < P; ++i) deepest = smaller(deepest, s[i]);
  return deepest;
}

// Handles lanes with a point deeper than the maximum bias velocity removes. u: the separation
// speeds. The limit of the bias velocity is raised by the speed that softness takes from the load.
// A position correction handles the remainder: velocities that many deep contacts add up would
// remain.
template <int W, int P>
void apply_deep(LanesOf<W, P>& c, const Normals<W, P>& normals, const Soft& soft, const Lanes<W>* u,
                const Lanes<W>* s, Lanes<W>* bias) {
  using F = Lanes<W>;
  auto& block = c.block();
  const F fraction = c.fraction(), zero(0.0f);
  const F by_load = sum_of_impulses(c) * (c.inverse_mass_a() + c.inverse_mass_b());
  const F fastest =
      F(soft.max_bias_velocity) * fraction + F((1.0f - soft.fraction) / soft.fraction) * by_load;
  const F shift = F(soft.fastest_shift) * fraction;
  F lacking(0.0f);
  for (int i = 0; i < P; ++i) {
    const F target = -(F(soft.rate) * s[i]);
    bias[i] = select(s[i] > zero, bias[i], -smaller(target, fastest));
    c.put(block.bias[i], bias[i]);
    lacking = larger(lacking, smaller(target, shift) - larger(fastest, u[i]));
  }
  F by_a, by_b;
  c.split(by_a, by_b);
  const F displacement = F(soft.h) * lacking;
  c.x_a -= (by_a * displacement) * normals.n;
  c.x_b += (by_b * displacement) * normals.n;
  c.scatter_displacements();
}

// Computes the bias on top of the separation speeds. For a positive separation it is the speed that
// closes it, positive; otherwise the bias velocity, negative or zero. Iterations after the first
// reuse the stored bias: poses do not change between them. In the relax pass of the last sub-step
// it returns the lanes that are too deep.
template <int W, int P, Pass kPass>
LaneMask<W> find_bias(LanesOf<W, P>& c, const Normals<W, P>& normals, const Soft& soft,
                      const Lanes<W>* u, Lanes<W>* bias) {
  using F = Lanes<W>;
  auto& block = c.block();
  LaneMask<W> too_deep = F(0.0f) > F(0.0f);
  if constexpr (kPass == Pass::again) {
    for (int i = 0; i < P; ++i) bias[i] = c.get(block.bias[i]);
    return too_deep;
  }
  F s[P];
  normals.separations(c, s);
  F max_bias(0.0f);
  if constexpr (kPass == Pass::first) max_bias = F(-soft.max_bias_velocity) * c.fraction();
  for (int i = 0; i < P; ++i) {
    const F closed = kPass == Pass::relax ? F(0.0f) : larger(F(soft.rate) * s[i], max_bias);
    bias[i] = select(s[i] > F(0.0f), F(soft.inverse_h) * s[i], closed);
    if constexpr (kPass == Pass::first) c.put(block.bias[i], bias[i]);
  }
  if constexpr (kPass == Pass::first) {
    const auto deep = F(soft.rate) * deepest_of<W, P>(s) < max_bias;
    if (!none(deep)) apply_deep(c, normals, soft, u, s, bias);
  } else if (soft.last) {
    const auto there = c.get(block.inverse[0]) > F(0.0f);  // not an empty slot
    too_deep = both(there, deepest_of<W, P>(s) < F(-kTooDeep) * c.get(block.slid_limit));
  }
  return too_deep;
}

// Returns true if a contact is too deep.
template <int W, int P, Pass kPass>
bool solve_lanes(LanesOf<W, P>& c, const Soft& soft) {
  using F = Lanes<W>;
  constexpr bool kUseBias = kPass != Pass::relax;
  auto& block = c.block();
  LaneMask<W> acts = F(0.0f) <= F(0.0f);
  if constexpr (kPass == Pass::again) {
    acts = c.get(block.active) > F(0.0f);
    if (none(acts)) return false;
    c.gather_velocities();
  } else {
    c.gather_velocities_and_displacements();
  }
  const Normals<W, P> normals(c);
  const auto grips = solve_friction(c, normals, acts);

  F u[P], bias[P], p0[P], p[P], mass[P], fraction[P], limit[P];
  normals.speeds(c, u);
  const auto too_deep = find_bias<W, P, kPass>(c, normals, soft, u, bias);
  for (int i = 0; i < P; ++i) {
    const auto open = bias[i] > F(0.0f);
    u[i] += bias[i];
    p0[i] = p[i] = c.get(block.impulse[i]);
    fraction[i] = kUseBias ? select(open, F(1.0f), F(soft.fraction)) : F(1.0f);
    mass[i] = fraction[i] * c.get(block.inverse[i]);
    if constexpr (kPass == Pass::again) {
      fraction[i] = select(acts, fraction[i], F(1.0f));
      mass[i] = select(acts, mass[i], F(0.0f));
    }
    // The next sub-step handles a separation that closes in it: it may be a bounce.
    if constexpr (!kUseBias) limit[i] = select(open, p0[i], F(kLargestImpulse));
  }
  const Points<W, P> points(c, mass, fraction, u, p0);
  const auto sweep = [&](const auto& next_of) {
    F moved(0.0f), load(0.0f);
    for (int i = 0; i < P; ++i) {
      F next = larger(points.target(i, p), F(0.0f));
      if constexpr (!kUseBias) next = smaller(next, limit[i]);
      next = next_of(next, p[i]);
      moved = larger(moved, abs(next - p[i]));
      load += next;
      p[i] = next;
    }
    return moved <= F(kConverged) * load;
  };
  auto converged = sweep([](const F& next, const F&) { return next; });
  for (int k = 1; P > 1 && k < kInnerSweeps && !all(converged); ++k) {
    // A converged lane does not change, so that its result is independent of the other lanes.
    const auto before_it = converged;
    const auto more =
        sweep([&](const F& next, const F& last) { return select(before_it, last, next); });
    converged = either(before_it, more);
  }
  F change[P], load(0.0f), moved(0.0f);
  auto quiet = F(0.0f) <= F(0.0f);
  for (int i = 0; i < P; ++i) {
    change[i] = p[i] - p0[i];
    c.put(block.impulse[i], p[i]);
    load += p[i];
    moved = larger(moved, abs(change[i]));
    // Matters only for contacts without a load.
    quiet = both(quiet, points.approach_speed(i) + F(soft.idle_speed) * mass[i] <= F(0.0f));
  }
  normals.apply_impulse(c, change);
  c.scatter_velocities();
  const auto loaded = load > F(0.0f);
  if constexpr (kUseBias) {
    const auto rests = both(moved <= F(kConvergedForNow) * load, either(loaded, quiet));
    // A skipped contact stays skipped: whether it was processed depends on the other lanes of the
    // pack.
    c.put(block.active, select(both(acts, !both(grips, rests)), F(1.0f), F(0.0f)));
  } else {
    c.put(block.given, F(soft.keeps_load) * c.get(block.given) + load);
    const auto idle = neither_bounces_nor_comes_to_touch(loaded, c.get(block.restitution));
    const auto there = c.get(block.inverse[0]) > F(0.0f);  // not an empty slot
    c.put(block.active, select(both(!idle, there), F(1.0f), F(0.0f)));
  }
  return !none(too_deep);
}

}  // namespace vp::solve
