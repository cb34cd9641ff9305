// The restitution pass, and the per-step queries of contacts.
//
// apply_restitution: a contact that approaches faster than the threshold and touches within the
// sub-step h hits. If it has restitution, it bounces immediately, one contact after another: each
// changes the bodies' velocities by Newton's impact law. So an impact propagates through a row of
// balls as in Newton's cradle. The displacements of its bodies are shifted for the time of impact
// within the sub-step, to where the new velocities lead to the right place at its end: that may be
// behind what was hit, so that contacts are searched for without the shifts.
//
// Velocities include the forces of the whole sub-step, so they are its midpoint velocities. With c
// the approach speed, g the acceleration that closes the separation s (of bodies in free fall; 0
// for bodies that were supported in the last step):
//   at the surface     a = sqrt((c - g h / 2)^2 + 2 g s),       reached after t
//   after the bounce   u = e a - g (h / 2 - t)                  midpoint velocity of the sub-step
//   and at its end     s' = e a (h - t) - g (h - t)^2 / 2
// So a bouncing ball keeps the heights of the true parabola, for any step.
#pragma once

#include "solve/contact_passes.h"

namespace vp::solve {

// Max iterations over the points of one contact for the restitution impulses. A box that falls on a
// corner needs one, on a face some more; points that are close to each other need many: with
// eight, a body gained up to a fifth of its energy.
inline constexpr int kRestitutionSweeps = 100;
inline constexpr float kRestitutionConverged =
    1e-5f;  // change of a point, as a fraction of the load

template <int W, int P>
struct Approaching {
  using F = Lanes<W>;

  Approaching(const LanesOf<W, P>& c, const Normals<W, P>& normals, float h) {
    normals.speeds(c, u);
    normals.separations(c, s);
    closes = F(0.0f) > F(0.0f);
    for (int i = 0; i < P; ++i) {
      separation[i] = larger(F(0.0f), s[i]);
      reaches[i] = F(h) * -u[i] >= separation[i];
      closes = either(closes, reaches[i]);
    }
  }
  // The time and speed of the points that reach the surface within h.
  void find_approach(const LanesOf<W, P>& c, const Normals<W, P>& normals, float h) {
    Vec3T<F> a, b;
    c.gather_accelerations(a, b);
    acceleration = larger(F(0.0f), dot(normals.n, c.falls_a * a - c.falls_b * b));
    const F added = F(h) * dot(normals.n, a - b);
    soonest = F(h);
    fastest = F(0.0f);
    for (int i = 0; i < P; ++i) {
      const F now = -u[i] - added;  // the forces of this sub-step alone are no approach
      reaches[i] = both(reaches[i], now > F(0.0f));
      fastest = larger(fastest, select(reaches[i], now, F(0.0f)));
      const F time = separation[i] / larger(-u[i], F(1e-30f));
      soonest = select(reaches[i], smaller(soonest, time), soonest);
    }
  }
  F u[P], s[P], separation[P], acceleration, soonest, fastest;
  LaneMask<W> reaches[P], closes;  // reaches: a point within h; closes: any point of the lane
};

// Returns true if any lane bounced. Skips blocks that the relax pass has found idle.
template <int W, int P>
bool apply_restitution_lanes(LanesOf<W, P>& c, float h, float threshold, BounceShift* shifts) {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  auto& block = c.block();
  if (none(c.get(block.active) > F(0.0f))) return false;
  const auto rests = sum_of_impulses(c) > F(0.0f);
  const F e = c.get(block.restitution);
  const auto idle = neither_bounces_nor_comes_to_touch(rests, e);
  c.gather_velocities_and_displacements();
  const Normals<W, P> normals(c);
  Approaching<W, P> approach_speed(c, normals, h);
  if (none(both(approach_speed.closes, !idle))) return false;
  approach_speed.find_approach(c, normals, h);
  const auto hits = approach_speed.fastest > F(threshold);
  if (none(hits)) return false;
  const auto fresh = both(hits, !rests);
  c.put(block.approach_speed,
        select(fresh, larger(c.get(block.approach_speed), approach_speed.fastest),
               c.get(block.approach_speed)));
  const auto bounces = both(hits, e > F(0.0f));
  if (none(bounces)) return false;

  F u[P], p[P], mass[P], fraction[P];
  const F after = F(h) - approach_speed.soonest;
  F leaving(0.0f), gained(0.0f);
  for (int i = 0; i < P; ++i) {
    const F start =
        larger(F(0.0f), -approach_speed.u[i] - F(0.5f * h) * approach_speed.acceleration);
    const F at_surface =
        sqrt(start * start + F(2.0f) * approach_speed.acceleration * approach_speed.separation[i]);
    const F target =
        e * at_surface - approach_speed.acceleration * (F(0.5f * h) - approach_speed.soonest);
    leaving = larger(leaving, select(approach_speed.reaches[i], e * at_surface, F(0.0f)));
    const auto acts = both(bounces, approach_speed.reaches[i]);
    u[i] = approach_speed.u[i] - target;
    mass[i] = select(acts, c.get(block.inverse[i]), F(0.0f));
    fraction[i] = select(acts, F(1.0f), F(0.0f));
    p[i] = F(0.0f);
  }
  const Points<W, P> points(c, mass, fraction, u, p);
  for (int i = 0; i < P; ++i) p[i] = points.shared(i, fraction);
  auto sweeps = bounces;  // a converged lane does not change
  for (int sweep = 0; sweep < (P > 1 ? kRestitutionSweeps : 1) && !none(sweeps); ++sweep) {
    F moved(0.0f), sum(0.0f);
    for (int i = 0; i < P; ++i) {
      const F next = select(sweeps, larger(points.target(i, p), F(0.0f)), p[i]);
      moved = larger(moved, abs(next - p[i]));
      sum += next;
      p[i] = next;
    }
    sweeps = both(sweeps, moved > F(kRestitutionConverged) * sum);
  }
  F load = p[0];
  for (int i = 1; i < P; ++i) load += p[i];
  c.put(block.impact, c.get(block.impact) + load);
  const V v_a = c.v_a, w_a = c.w_a, v_b = c.v_b, w_b = c.w_b;
  normals.apply_impulse(c, p);

  // Corrects the displacements: the whole sub-step will be integrated with the new velocities.
  F now[P];
  normals.speeds(c, now);
  for (int i = 0; i < P; ++i) {
    gained =
        larger(gained, select(approach_speed.reaches[i], now[i] - approach_speed.u[i], F(0.0f)));
  }
  F speed = now[0], separation = approach_speed.s[0];
  for (int i = 1; i < P; ++i) {
    const auto first = both(approach_speed.reaches[i], approach_speed.s[i] < separation);
    speed = select(first, now[i], speed);
    separation = select(first, approach_speed.s[i], separation);
  }
  const F target = leaving * after - F(0.5f) * approach_speed.acceleration * after * after;
  const F error = target - (larger(F(0.0f), separation) + F(h) * speed);
  const auto moves = both(bounces, gained > F(1e-9f));
  const F part = select(moves, clamped(error / larger(gained, F(1e-9f)), F(h)), F(0.0f));
  c.shift(part * (c.v_a - v_a), part * (c.w_a - w_a), part * (c.v_b - v_b), part * (c.w_b - w_b),
          shifts);

  // Friction during the bounce.
  const Grip<W, P> at(c, normals);
  const V slip = at.velocity(c);
  const F slide[2] = {dot(at.t, slip) - c.get(block.surface_speed[0]),
                      dot(at.b, slip) - c.get(block.surface_speed[1])};
  F q[2] = {F(0.0f), F(0.0f)};
  grip_or_slide(c, slide, c.get(block.friction) * load, q);
  const V force = q[0] * at.t + q[1] * at.b;
  c.apply_linear(force);
  c.apply_angular(cross(at.r_a, force), cross(at.r_b, force));
  c.scatter_velocities();
  return true;
}

// Bits of slots whose geometry must be computed again: by the end of a step of dt, at their present
// speeds, they will have slid by more than slid_limit or rotated by more than `rotation` [rad]. For
// bodies that no impulse moves the limit is kDrivenRotation: a motor-driven body may have long
// arms, and bodies on it drift outwards by the error of its old geometry.
inline constexpr float kDrivenRotation = 5e-4f;  // [rad]
template <int W, int P>
std::uint32_t find_moved_slots(LanesOf<W, P>& c, float dt, float rotation) {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  auto& block = c.block();
  c.gather_velocities_and_displacements();
  const V r_a = c.get(block.grip), r_b = r_a + c.get(block.d);
  const F step(dt);
  const V x_a = c.x_a + step * c.v_a, x_b = c.x_b + step * c.v_b;
  const V rotation_a = c.rotation_a + step * c.w_a, rotation_b = c.rotation_b + step * c.w_b;
  const V slid = x_b + cross(rotation_b, r_b) - x_a - cross(rotation_a, r_a) - c.get(block.slid);
  const V by_a = rotation_a - c.get(block.rotated_a), by_b = rotation_b - c.get(block.rotated_b);
  const F limit = c.get(block.slid_limit), own(rotation * rotation),
          driven(kDrivenRotation * kDrivenRotation);
  const auto still = both(both(dot(slid, slid) <= limit * limit,
                               dot(by_a, by_a) <= select(c.is_movable_a(), own, driven)),
                          dot(by_b, by_b) <= select(c.is_movable_b(), own, driven));
  return lanes::bits_of(!still);
}

// Bits of slots that hit, or whose reported touching state has changed. From bit kLanes on: the
// slots that touch: with a load now or, with keeps_load 1, in an earlier sub-step of the step.
template <int W, int P>
std::uint32_t find_changed_slots(const LanesOf<W, P>& c, int at, float keeps_load) {
  using F = Lanes<W>;
  const F zero(0.0f), impact = c.get(c.block().impact);
  const auto loaded = sum_of_impulses(c) + impact > zero;
  const auto touched = either(loaded, F(keeps_load) * c.get(c.block().given) > zero);
  const auto hits = c.get(c.block().approach_speed) + impact > zero;
  std::uint32_t bits = 0;
  for (int i = 0; i < W; ++i) {
    const bool pushes = touched.lanes[i] != 0;
    if (loaded.lanes[i] != 0) c.mark_supported(i);
    const bool changed = hits.lanes[i] != 0 || pushes != (c.block().touches.lane[at + i] != 0);
    bits |= (changed ? 1u : 0u) << i | (pushes ? 1u << kLanes : 0u) << i;
  }
  return bits;
}

// Bits of speculative pairs that may use up their clearance by the end of a step of dt, or have
// parted by as much: they may have left each other's bounds.
template <int W>
std::uint32_t find_closer_pairs(const SpeculativePair* pairs, BodyState* states, float dt) {
  using F = Lanes<W>;
  using V = Vec3T<F>;
  F of_pair[24];  // the fields of SpeculativePair in their order
  for (int c = 0; c < 24; c += 8) {
    lanes::gather8<W>([&](int i) { return reinterpret_cast<const float*>(&pairs[i]) + c; },
                      of_pair + c);
  }
  const auto get3 = [&](int f) { return V{of_pair[f], of_pair[f + 1], of_pair[f + 2]}; };
  const auto gather = [&](std::uint32_t SpeculativePair::*state, V& x, V& rotation) {
    F velocity[8], displacement[8];
    lanes::gather8<W>([&](int i) { return states[pairs[i].*state].velocity; }, velocity);
    lanes::gather8<W>([&](int i) { return states[pairs[i].*state].displacement; }, displacement);
    const F step(dt);
    x = V{displacement[0], displacement[1], displacement[2]} +
        step * V{velocity[0], velocity[1], velocity[2]};
    rotation = V{displacement[3], displacement[4], displacement[5]} +
               step * V{velocity[3], velocity[4], velocity[5]};
  };
  V x_a, rotation_a, x_b, rotation_b;
  gather(&SpeculativePair::a, x_a, rotation_a);
  gather(&SpeculativePair::b, x_b, rotation_b);
  rotation_a -= get3(3);
  rotation_b -= get3(6);
  const V arm_a = get3(9), arm_b = get3(12), normal = get3(15);
  const V moved = x_b - x_a - get3(0) + cross(rotation_b, arm_b) - cross(rotation_a, arm_a);
  const auto size = [](const V& v) { return sqrt(dot(v, v)); };
  // A rotating arm leaves its tangent by half of the squared angle.
  const auto arc_error = [&](const V& rotation, const V& arm) {
    return F(0.5f) * dot(rotation, rotation) * size(arm);
  };
  const F with_a = larger(of_pair[20], F(0.0f)), with_b = F(1.0f) - abs(of_pair[20]);
  const F turned = (with_a * size(rotation_a) + with_b * size(rotation_b)) * size(moved);
  const auto is_directed = F(0.0f) < dot(normal, normal);
  const F approach = select(is_directed, turned - dot(normal, moved), size(moved)) +
                     of_pair[18] * size(rotation_b - rotation_a) + arc_error(rotation_a, arm_a) +
                     arc_error(rotation_b, arm_b);
  const auto stays = abs(approach) <= of_pair[19];
  return lanes::bits_of(!stays);
}

}  // namespace vp::solve
