// Rows: with J the wrench of a unit impulse on both bodies and W the inverse inertia, an impulse p
// changes the row's speed by k p, k = J W J^T. A link contributes (y, y) to k (link_side.h). Two
// links of one articulation contribute the product of the sum of both y. The rows are solved in
// sequence (projected Gauss-Seidel):
//     normal    p_n >= 0,          speed >= target
//     friction  |p_t| <= mu p_n,   a disc, not a box: two rows solved together
//     rolling   |p_r| <= rho p_n,  moments
// Restitution is a second solve. Contacts that approached faster than the threshold and had an
// impulse in the first solve get a target speed of e times their approach speed.
//
// Approach speed and target are those of the true parabola: the velocities contain the forces of
// the whole step from its start. With u the outward speed at the start of a step dt, x the height
// and a constant acceleration -g, semi-implicit Euler conserves u^2 / 2 + g x - u g dt / 2. For a
// contact that approaches at u1 (the step's forces included) with h of the step left and a
// separation s, this gives
//     approach^2 = (u1 - early)^2 + 2 g s,    early = g (h - dt / 2),
//     (target + early)^2 = (e approach)^2 - 2 g s,
// neglecting (g dt)^2 / 4. A body at rest approaches at u1 = g dt in each step. So u1 - g h, the
// speed that the forces have produced by now, decides whether a contact bounces.
//
// A third set of impulses removes penetration. It acts on positions only and so adds no energy.
// Sources: Catto 2006 (sequential impulses); Moreau 1988 for the disc; Jolt and Box2D for the
// separate position correction.
#include "solve/contact_solver.h"

#include <algorithm>
#include <cmath>

#include "solve/dense_island.h"
#include "solve/impulses.h"
#include "solve/instant_scratch.h"

namespace vp::solve {
namespace {

// With few contacts more iterations cost little, and a light ball between heavy bodies needs them:
// the error shrinks by M / (M + m) per iteration. The requested iterations are multiplied by
// kFewContacts / contacts, at most by kMaxIterations.
constexpr std::size_t kFewContacts = 32;
constexpr std::size_t kMaxIterations = 8;
// A small island that converges within this many iterations needs no matrix, for instance one that
// also rested in the last step.
constexpr int kIterationsWithoutMatrix = 3;
// The fraction of the penetration beyond the slop that one solve removes, the maximum correction
// [m], and the iterations. A larger fraction makes stacks jitter.
constexpr double kCorrectionFraction = 0.2;
constexpr double kMaxCorrected = 0.002;
constexpr int kCorrectionIterations = 8;

// Two links of one tree can be nearly locked to each other along their contact normal, as two that
// overlap near the joints between them: they would have to swing far to separate. If their response
// to an impulse on both is below this fraction of the sum of their single responses, the position
// correction is reduced, so that joints move no faster than at that fraction.
constexpr double kMinLeverage = 0.01;

// The speed along d2 that a unit impulse along d1 produces at a point; r1 and r2 are their rows.
double response(const SolverBody& a, const SolverBody& b, const ContactConstraint& c,
                const ContactPoint& p, const Vec3& d1, const Vec3& d2, int r1, int r2) {
  double sum = 0.0;
  if (c.moves_a) {
    sum += dot(d1, a.inverse_mass * d2) + dot(cross(p.arm_a, d1), a.angular * cross(p.arm_a, d2));
  }
  if (c.moves_b) {
    sum += dot(d1, b.inverse_mass * d2);
    sum += dot(cross(p.arm_b, d1), b.angular * cross(p.arm_b, d2));
  }
  return sum + response(c.side_a, c.side_b, r1, r2);
}

void prepare_tangents(const SolverBody& a, const SolverBody& b, const ContactConstraint& c,
                      ContactPoint& p, int row) {
  const Vec3 &d1 = c.tangent[0], &d2 = c.tangent[1];
  const double k11 = response(a, b, c, p, d1, d1, row, row);
  const double k12 = response(a, b, c, p, d1, d2, row, row + 1);
  const double k22 = response(a, b, c, p, d2, d2, row + 1, row + 1);
  const double determinant = k11 * k22 - k12 * k12, trace = k11 + k22;
  // Nearly singular if only a joint can yield. Then one mass serves both directions: this converges
  // for any positive semidefinite block.
  if (determinant > 1e-6 * trace * trace) {
    p.tangent_mass[0] = k22 / determinant;
    p.tangent_mass[1] = -k12 / determinant;
    p.tangent_mass[2] = k11 / determinant;
  } else {
    const double m = trace > 0.0 ? 1.0 / trace : 0.0;
    p.tangent_mass[0] = p.tangent_mass[2] = m;
    p.tangent_mass[1] = 0.0;
  }
  const double largest = 0.5 * (trace + std::sqrt((k11 - k22) * (k11 - k22) + 4.0 * k12 * k12));
  p.slide_mass = largest > 0.0 ? 1.0 / largest : 0.0;
}

// The largest row sum is an upper bound of the largest eigenvalue; for a ball they are equal.
double rolling_mass(const SolverBody& a, const SolverBody& b, const ContactConstraint& c) {
  Sym3 K = a.angular + b.angular;
  const int r = row_of(c.count, 0);
  const auto k = [&](int i, int j) { return response(c.side_a, c.side_b, r + i, r + j); };
  if (c.has_links()) K = K + Sym3{k(0, 0), k(1, 1), k(2, 2), k(0, 1), k(1, 2), k(2, 0)};
  const double x = std::fabs(K.xx) + std::fabs(K.xy) + std::fabs(K.zx);
  const double y = std::fabs(K.xy) + std::fabs(K.yy) + std::fabs(K.yz);
  const double z = std::fabs(K.zx) + std::fabs(K.yz) + std::fabs(K.zz);
  const double max_value = std::max({x, y, z});
  return max_value > 0.0 ? 1.0 / max_value : 0.0;
}

void prepare_approach(const StepContext& s, const SolverBody& a, const SolverBody& b,
                      const ContactConstraint& c, ContactPoint& p) {
  const Vec3 forced =
      b.forced_v + cross(b.forced_w, p.arm_b) - a.forced_v - cross(a.forced_w, p.arm_a);
  const double approach_speed = -dot(c.normal, relative_velocity(a, b, c, p));
  const double forced_speed = -dot(c.normal, forced);  // g dt
  const double left = s.duration / s.step;
  // A swept body is at its contact; its separation is within the tolerance.
  const double separation = c.swept ? 0.0 : std::max(0.0, p.separation);
  p.early = forced_speed * (left - 0.5);
  p.fall = 2.0 * forced_speed / s.step * separation;
  const double speed = std::max(0.0, approach_speed - p.early);
  p.approach = std::sqrt(std::max(0.0, speed * speed + p.fall));
  p.hits = approach_speed - forced_speed * left > s.restitution_threshold;
  p.bounces = false;
}

double correction_fraction(const ContactConstraint& c, int row, double k) {
  if (!of_one_tree(c.side_a, c.side_b)) return 1.0;
  const double each = response(c.side_a, row, row) + response(c.side_b, row, row);
  return k < kMinLeverage * each ? std::sqrt(k / (kMinLeverage * each)) : 1.0;
}

// A positive separation may close within the step. In sub-steps, a bias velocity removes
// penetration. Not for two links of one tree, since it would jerk their joints: they get a position
// correction.
double target_of(const StepContext& s, const ContactConstraint& c, const ContactPoint& p) {
  const bool pushed = !of_one_tree(c.side_a, c.side_b);
  const double deep = pushed ? std::max(0.0, -p.separation - s.slop) : 0.0;
  return std::min(s.bias_rate * deep, s.max_bias_velocity) -
         std::max(0.0, p.separation - s.slop) / s.duration;
}

void prepare(const StepContext& s, ContactConstraint& c) {
  const SolverBody &a = s.bodies[c.a], &b = s.bodies[c.b];
  c.moves_a = moves(a);
  c.moves_b = moves(b);
  c.stands_a = !c.moves_a && a.v == Vec3{} && a.w == Vec3{};
  c.stands_b = !c.moves_b && b.v == Vec3{} && b.w == Vec3{};
  c.rolling_mass = c.rolling > 0.0 ? rolling_mass(a, b, c) : 0.0;
  for (int i = 0; i < c.count; ++i) {
    ContactPoint& p = c.points[i];
    p.arm_a = p.position - a.x;
    p.arm_b = p.position - b.x;
    const int row = row_of(i, kNormal);
    const double k = response(a, b, c, p, c.normal, c.normal, row, row);
    p.normal_mass = k > 1e-12 ? 1.0 / k : 0.0;
    p.correction_fraction = correction_fraction(c, row, k);
    prepare_tangents(a, b, c, p, row_of(i, kTangent));
    prepare_approach(s, a, b, c, p);
    p.target = target_of(s, c, p);
    p.position_impulse = 0.0;
    if (!c.is_steady()) continue;
    const PointSpeeds speeds = speeds_of(a, b, c, p);
    std::copy(std::begin(speeds.along), std::end(speeds.along), std::begin(p.steady));
  }
}

void warm_start(const StepContext& s) {
  for (ContactConstraint& c : s.contacts) {
    SolverBody &a = s.bodies[c.a], &b = s.bodies[c.b];
    for (int i = 0; i < c.count; ++i) {
      const ContactPoint& p = c.points[i];
      apply(a, b, c, p,
            p.normal_impulse * c.normal + p.tangent_impulse[0] * c.tangent[0] +
                p.tangent_impulse[1] * c.tangent[1]);
      apply_to_links(c, row_of(i, kNormal), p.normal_impulse);
      apply_to_links(c, row_of(i, kTangent), p.tangent_impulse[0]);
      apply_to_links(c, row_of(i, kTangent + 1), p.tangent_impulse[1]);
    }
    if (c.rolling_mass > 0.0) apply_moment(a, b, c, c.rolling_impulse);
  }
  for (const JointRow& row : s.joints) give(s, row, row.impulse);
}

// Returns the change of speed.
double solve_friction(SolverBody& a, SolverBody& b, const ContactConstraint& c, ContactPoint& p,
                      int row) {
  // Without a load there is none.
  if (p.normal_impulse == 0.0 && p.tangent_impulse[0] == 0.0 && p.tangent_impulse[1] == 0.0)
    return 0.0;
  double u[2] = {p.steady[1], p.steady[2]};
  if (!c.is_steady()) {
    const Vec3 all = relative_velocity(a, b, c, p);
    for (int k = 0; k < 2; ++k) u[k] = dot(c.tangent[k], all);
  }
  double next[2] = {p.tangent_impulse[0], p.tangent_impulse[1]};
  friction_after(c, p, u[0] + through_links(c, row) - c.surface_speed[0],
                 u[1] + through_links(c, row + 1) - c.surface_speed[1], p.normal_impulse, next);
  const double change0 = next[0] - p.tangent_impulse[0], change1 = next[1] - p.tangent_impulse[1];
  apply(a, b, c, p, change0 * c.tangent[0] + change1 * c.tangent[1]);
  apply_to_links(c, row, change0);
  apply_to_links(c, row + 1, change1);
  p.tangent_impulse[0] = next[0];
  p.tangent_impulse[1] = next[1];
  return p.slide_mass > 0.0 ? std::sqrt(change0 * change0 + change1 * change1) / p.slide_mass : 0.0;
}

double solve_rolling(SolverBody& a, SolverBody& b, ContactConstraint& c) {
  const int r = row_of(c.count, 0);
  const Vec3 turning =
      b.w - a.w + Vec3{through_links(c, r), through_links(c, r + 1), through_links(c, r + 2)};
  double load = 0.0;
  for (int i = 0; i < c.count; ++i) load += c.points[i].normal_impulse;
  const Vec3 next = rolling_after(c, c.rolling_impulse, turning, load);
  const Vec3 by = next - c.rolling_impulse;
  apply_moment(a, b, c, by);
  c.rolling_impulse = next;
  return norm(by) / c.rolling_mass;
}

// Returns the change of speed.
double solve_normal(SolverBody& a, SolverBody& b, const ContactConstraint& c, ContactPoint& p,
                    int row) {
  const double own = c.is_steady() ? p.steady[0] : dot(c.normal, relative_velocity(a, b, c, p));
  const double speed = own + through_links(c, row);
  const double next = std::max(0.0, p.normal_impulse + p.normal_mass * (p.target - speed));
  const double change = next - p.normal_impulse;
  if (change == 0.0) return 0.0;
  p.normal_impulse = next;
  apply(a, b, c, p, change * c.normal);
  apply_to_links(c, row, change);
  return p.normal_mass > 0.0 ? std::fabs(change) / p.normal_mass : 0.0;
}

double solve_contact(const StepContext& s, ContactConstraint& c) {
  SolverBody &a = s.bodies[c.a], &b = s.bodies[c.b];
  double change = 0.0;
  if (c.rolling_mass > 0.0) change = std::max(change, solve_rolling(a, b, c));
  for (int i = 0; i < c.count; ++i) {
    change = std::max(change, solve_friction(a, b, c, c.points[i], row_of(i, kTangent)));
  }
  for (int i = 0; i < c.count; ++i) {
    change = std::max(change, solve_normal(a, b, c, c.points[i], row_of(i, kNormal)));
  }
  return change;
}

// Alternate iterations run in reverse order, so that a load propagates up a stack as fast as down.
double one_iteration(const StepContext& s, std::span<const std::uint32_t> contacts,
                     std::span<const std::uint32_t> joints, bool forward) {
  double change = 0.0;
  for (const std::uint32_t i : joints) change = std::max(change, solve_joint(s, s.joints[i]));
  const std::size_t n = contacts.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t i = contacts[forward ? k : n - 1 - k];
    change = std::max(change, solve_contact(s, s.contacts[i]));
  }
  return change;
}

// Joint rows of an articulation that is not touched are independent of the rest: they are solved to
// convergence first, and later iterations skip them. Rows that do not affect one another, as of a
// rod that slides and rotates, need one iteration.
void integrate_untouched(const StepContext& s) {
  for (std::size_t begin = 0, end = 0; begin < s.joints.size(); begin = end) {
    if (s.joints[begin].pair != kNoPair) return;  // rows of joints between bodies come last
    const std::uint32_t own = s.joints[begin].articulation;
    bool coupled = false;
    const auto is_own = [&](const JointRow& row) {
      return row.pair == kNoPair && row.articulation == own;
    };
    for (; end < s.joints.size() && is_own(s.joints[end]); ++end) {
      coupled = coupled || is_coupled(s.joints[end].side) ||
                (end > begin && s.joints[end].dof == s.joints[end - 1].dof);
    }
    if (s.articulations[own].touched) continue;
    const int max_value = coupled ? s.iterations * static_cast<int>(kMaxIterations) : 1;
    for (int i = 0; i < max_value; ++i) {
      double change = 0.0;
      for (std::size_t k = begin; k < end; ++k) {
        change = std::max(change, solve_joint(s, s.joints[k]));
      }
      if (change < convergence_tolerance(s)) break;
    }
  }
}

// In sub-steps contact blocks soon change what has converged, so plain iterations suffice. Rows of
// joints between bodies are strongly coupled and do need convergence, unless contact blocks act on
// the bodies too.
bool goes_to_the_end(const StepContext& s, const Island& island) {
  if (s.bias_rate == 0.0) return true;
  const Islands& islands = s.scratch.islands;
  const auto in_blocks = [&](std::uint32_t body) { return s.bodies[body].in_blocks; };
  bool joined = false;
  for (const std::uint32_t i : islands.joints(island)) {
    if (s.joints[i].pair == kNoPair) continue;
    const JointPair& pair = s.pairs[s.joints[i].pair];
    if (in_blocks(pair.a.body) || in_blocks(pair.b.body)) return false;
    joined = true;
  }
  for (const std::uint32_t i : islands.contacts(island)) {
    if (in_blocks(s.contacts[i].a) || in_blocks(s.contacts[i].b)) return false;
  }
  return joined;
}

void iterate(const StepContext& s) {
  const Islands& islands = s.scratch.islands;
  for (const Island& island : islands.all()) {
    const auto contacts = islands.contacts(island), joints = islands.joints(island);
    const bool to_the_end = island.rows <= DenseIsland::kMaxRows && goes_to_the_end(s, island);
    const std::size_t more =
        to_the_end
            ? kMaxIterations
            : std::clamp<std::size_t>(kFewContacts / std::max<std::size_t>(1, contacts.size()), 1,
                                      kMaxIterations);
    const int iterations = s.iterations * static_cast<int>(more);
    const int first = to_the_end ? kIterationsWithoutMatrix : iterations;
    bool converged = false;
    for (int i = 0; i < std::min(first, iterations) && !converged; ++i) {
      converged = one_iteration(s, contacts, joints, i % 2 == 0) < convergence_tolerance(s);
    }
    if (converged || first >= iterations) continue;
    DenseIsland(s, islands, island, s.scratch.dense).iterate(iterations - first);
  }
}

// Preparation common to all iterations.
void begin(const StepContext& s) {
  prepare_link_rows(s);
  for (ContactConstraint& c : s.contacts) prepare(s, c);
  s.scratch.islands.find(s);
  warm_start(s);
  integrate_untouched(s);
}

bool set_bounce_targets(const StepContext& s) {
  bool any = false;
  for (ContactConstraint& c : s.contacts) {
    if (c.restitution <= 0.0) continue;
    for (int i = 0; i < c.count; ++i) {
      ContactPoint& p = c.points[i];
      if (!p.hits || p.normal_impulse <= 0.0) continue;
      const double leaving = c.restitution * p.approach;
      const double target = std::sqrt(std::max(0.0, leaving * leaving - p.fall)) - p.early;
      if (target <= p.target) continue;
      p.target = target;
      p.bounces = any = true;
    }
  }
  return any;
}

// Returns whether there was an error to correct.
bool correct_joint(const StepContext& s, const JointRow& row) {
  if (row.pair == kNoPair || row.mass == 0.0) return false;
  JointPair& pair = s.pairs[row.pair];
  if (pair.error == 0.0) return false;
  // A row at a bound moves nothing. A row that acts in one direction only does not move back
  // either.
  if ((row.upper > 0.0 && row.impulse >= row.upper) ||
      (row.lower < 0.0 && row.impulse <= row.lower))
    return false;
  double next = pair.position_impulse - (pair.error + speed_of(s, pair, kShift)) / pair.answer;
  if (row.lower >= 0.0) next = std::max(0.0, next);
  if (row.upper <= 0.0) next = std::min(0.0, next);
  give(s, pair, next - pair.position_impulse, kShift);
  pair.position_impulse = next;
  return true;
}

// In sub-steps bias velocities handle penetration, except between links of one tree.
void correct_positions(const StepContext& s) {
  const bool sub_step = s.bias_rate > 0.0;
  for (int iteration = 0; iteration < kCorrectionIterations; ++iteration) {
    bool any = false;
    for (const JointRow& row : s.joints) any |= correct_joint(s, row);
    for (std::size_t k = 0; k < s.contacts.size(); ++k) {
      ContactConstraint& c = s.contacts[iteration % 2 == 0 ? k : s.contacts.size() - 1 - k];
      if (sub_step && !of_one_tree(c.side_a, c.side_b)) continue;
      SolverBody &a = s.bodies[c.a], &b = s.bodies[c.b];
      for (int i = 0; i < c.count; ++i) {
        ContactPoint& p = c.points[i];
        const double target =
            p.correction_fraction *
            std::min(kCorrectionFraction * (-s.slop - p.separation), kMaxCorrected);
        if (target <= 0.0) continue;
        any = true;
        const int row = row_of(i, kNormal);
        const double moved =
            dot(c.normal,
                b.shift + cross(b.rotation, p.arm_b) - a.shift - cross(a.rotation, p.arm_a)) +
            along(c.side_a, row, c.side_a.shift) + along(c.side_b, row, c.side_b.shift);
        const double next = std::max(0.0, p.position_impulse + p.normal_mass * (target - moved));
        const double change = next - p.position_impulse;
        const Vec3 impulse = change * c.normal;
        p.position_impulse = next;
        a.shift -= a.inverse_mass * impulse;
        a.rotation -= a.angular * cross(p.arm_a, impulse);
        b.shift += b.inverse_mass * impulse;
        b.rotation += b.angular * cross(p.arm_b, impulse);
        apply_impulse(c.side_a, row, change, c.side_a.shift);
        apply_impulse(c.side_b, row, change, c.side_b.shift);
      }
    }
    if (!any) return;
  }
}

// The velocity of the body's contact point, including the changes by the solve through its joints.
Vec3 velocity_at(const SolverBody& body, const Vec3& arm, const ContactConstraint& c,
                 const LinkSide& side, double sign, int point) {
  Vec3 v = body.v + cross(body.w, arm);
  const Vec3* directions[] = {&c.normal, &c.tangent[0], &c.tangent[1]};
  for (int k = 0; k < kRowsOfPoint; ++k) {
    v += (sign * along(side, row_of(point, k), side.velocity)) * *directions[k];
  }
  return v;
}

}  // namespace

void set_normal(ContactConstraint& c, const Vec3& n) {
  const Vec3 t = std::fabs(n.x) < 0.6 ? Vec3{0, n.z, -n.y} : Vec3{-n.z, 0, n.x};
  c.normal = n;
  c.tangent[0] = (1.0 / norm(t)) * t;
  c.tangent[1] = cross(n, c.tangent[0]);
}

void solve(const StepContext& s) {
  begin(s);
  iterate(s);
  if (set_bounce_targets(s)) iterate(s);
  correct_positions(s);
}

void begin_sub_step(const StepContext& s) {
  begin(s);
}

void solve_sub_step(const StepContext& s) {
  iterate(s);
  if (set_bounce_targets(s)) iterate(s);
}

void advance_contacts(const StepContext& s, double h) {
  for (ContactConstraint& c : s.contacts) {
    for (int i = 0; i < c.count; ++i) {
      ContactPoint& p = c.points[i];
      const Vec3 a = velocity_at(s.bodies[c.a], p.arm_a, c, c.side_a, -1.0, i);
      const Vec3 b = velocity_at(s.bodies[c.b], p.arm_b, c, c.side_b, 1.0, i);
      p.separation += h * dot(c.normal, b - a);
      p.position += (0.5 * h) * (a + b);
    }
  }
}

void relax_sub_step(const StepContext& s) {
  for (ContactConstraint& c : s.contacts) {
    for (int i = 0; i < c.count; ++i) {
      ContactPoint& p = c.points[i];
      if (!p.bounces) p.target = std::min(p.target, 0.0);
    }
  }
  for (JointRow& row : s.joints) {
    if (row.pair == kNoPair || !s.pairs[row.pair].relaxes) continue;
    const JointPair& pair = s.pairs[row.pair];
    row.target = pair.relaxed_target;
    row.softness = pair.floor;
    if (row.mass > 0.0) row.mass = 1.0 / (row.inverse_mass + row.softness);
  }
  iterate(s);
  correct_positions(s);
}

void note_sub_step(std::span<ContactConstraint> contacts) {
  for (ContactConstraint& c : contacts) {
    for (int i = 0; i < c.count; ++i) {
      ContactPoint& p = c.points[i];
      if (p.normal_impulse <= 0.0) continue;
      p.step_impulse += p.normal_impulse;
      p.step_approach = std::max(p.step_approach, p.approach);
      p.step_hits = p.step_hits || p.hits;
    }
  }
}

}  // namespace vp::solve
