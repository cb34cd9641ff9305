#include "solve/link_rows.h"

#include <algorithm>

namespace vp::solve {
namespace {

// Sets everything except the rows themselves.
void attach(const SolverArticulation& art, std::uint32_t first, std::uint32_t depth,
            LinkSide& side) {
  side = {nullptr, art.factor->next(), art.velocity, art.shift, first, depth};
}

std::size_t attach(const StepContext& s, const ContactConstraint& c, std::uint32_t body,
                   LinkSide& side) {
  side = {};
  const SolverBody& link = s.bodies[body];
  if (link.articulation < 0) return 0;
  SolverArticulation& art = s.articulations[static_cast<std::size_t>(link.articulation)];
  // A contact on a link that is fixed to the world moves no joint.
  art.touched = art.touched || art.factor->depth(link.link) > 0;
  attach(art, art.factor->first(link.link), art.factor->depth(link.link), side);
  return static_cast<std::size_t>(rows_of(c)) * side.depth;
}

// Fills the rows of one side. sign: -1 for a, whose impulses are opposite to those on b.
double* fill(const StepContext& s, const ContactConstraint& c, std::uint32_t body, double sign,
             LinkSide& side, double* y) {
  if (side.depth == 0) return y;
  const SolverBody& link = s.bodies[body];
  const detail::ImpulseFactor& factor =
      *s.articulations[static_cast<std::size_t>(link.articulation)].factor;
  side.rows = y;
  const Vec3 directions[] = {sign * c.normal, sign * c.tangent[0], sign * c.tangent[1]};
  for (int i = 0; i < c.count; ++i) {
    factor.force_rows(link.link, c.points[i].position, directions, y);
    y += kRowsOfPoint * side.depth;
  }
  if (c.rolling > 0.0) {
    const Vec3 axes[] = {sign * Vec3{1, 0, 0}, sign * Vec3{0, 1, 0}, sign * Vec3{0, 0, 1}};
    factor.moment_rows(link.link, axes, y);
    y += kRowsOfPoint * side.depth;
  }
  return y;
}

// Returns the number of doubles that its rows need.
std::size_t attach(const StepContext& s, PairEnd& end) {
  const SolverBody& body = s.bodies[end.body];
  end.moves = moves(body);
  end.side = {};
  if (body.articulation < 0) return 0;
  SolverArticulation& art = s.articulations[static_cast<std::size_t>(body.articulation)];
  art.touched = art.touched || art.factor->depth(body.link) > 0;
  attach(art, art.factor->first(body.link), art.factor->depth(body.link), end.side);
  return 2 * std::size_t{end.side.depth};
}

// Fills y of a force along end.linear through the body's point plus a moment along end.angular.
double* fill(const StepContext& s, PairEnd& end, double* y) {
  const std::uint32_t depth = end.side.depth;
  if (depth == 0) return y;
  const SolverBody& body = s.bodies[end.body];
  const detail::ImpulseFactor& factor =
      *s.articulations[static_cast<std::size_t>(body.articulation)].factor;
  double* const of_moment = y + depth;
  factor.force_row(body.link, body.x, end.linear, y);
  factor.moment_row(body.link, end.angular, of_moment);
  for (std::uint32_t k = 0; k < depth; ++k) y[k] += of_moment[k];
  end.side.rows = y;
  return of_moment + depth;
}

// The change of the row's speed by a unit impulse.
double response_of(const StepContext& s, const JointPair& pair) {
  double sum = response(pair.a.side, pair.b.side, 0, 0);
  for (const PairEnd* end : {&pair.a, &pair.b}) {
    if (!end->moves) continue;
    const SolverBody& body = s.bodies[end->body];
    sum += body.inverse_mass * dot(end->linear, end->linear) +
           dot(end->angular, body.angular * end->angular);
  }
  return std::max(0.0, sum);
}

// An impulse cannot control a row with a response below this [1/kg or 1/(kg m^2)].
constexpr double kNoAnswer = 1e-12;
// Minimum response of a row, including its softness, as a fraction of the maximum response of its
// ends in any direction (in sub-steps kMinInSubSteps). The position correction uses kMinMoved
// instead. Where a tree is stretched, so that its end cannot move further, joints that pull it
// would otherwise throw its links about. The fraction is the square of the angle [rad] by which the
// tree must bend to respond as much. In sub-steps velocities are relaxed, and a heavy load on such
// a tree needs stiffer rows.
constexpr double kMinAnswer = 1e-2, kMinInSubSteps = 1e-4, kMinMoved = 1e-3;
// A drive's spring softer than this, in (steps times natural frequency)^2, is integrated without
// gain or loss of energy; a stiffer one increasingly implicitly.
constexpr double kExplicitDrive = 0.25;
// A drive whose response changes its impulse by a smaller fraction has a constant impulse.
constexpr double kNoGain = 1e-30;

// At a speed u after the step the impulse is drive_impulse - gain u.
void prepare_drive(const StepContext& s, const JointPair& pair, JointRow& row) {
  const double h = s.step, stiff = h * h * pair.stiffness * row.inverse_mass;
  const double implicit = stiff > kExplicitDrive ? 1.0 - kExplicitDrive / stiff : 0.0;
  const double gain = h * pair.damping + implicit * h * h * pair.stiffness;
  const double drive_impulse =
      h * (pair.damping * pair.drive_speed - pair.stiffness * pair.drive_error);
  if (gain * row.inverse_mass > kNoGain) {
    row.target = drive_impulse / gain;
    row.softness = 1.0 / gain;
  } else {
    row.lower = row.upper = std::clamp(drive_impulse, row.lower, row.upper);
  }
  row.impulse = std::clamp(row.impulse, row.lower, row.upper);
}

bool is_about_an_axis(const JointPair& pair) {
  return pair.a.linear == Vec3{} && pair.b.linear == Vec3{};
}

// The maximum response, over three axes, of the link to a unit impulse at the row's point, or to a
// unit moment; times the squared length of the row's direction.
double largest_answer(const StepContext& s, const PairEnd& end) {
  if (end.side.depth == 0) return 0.0;
  const SolverBody& body = s.bodies[end.body];
  const detail::ImpulseFactor& factor =
      *s.articulations[static_cast<std::size_t>(body.articulation)].factor;
  const double force = dot(end.linear, end.linear);
  const bool turns = force == 0.0;
  // The point at which a force along the row has the row's moment.
  const Vec3 at = turns ? Vec3{} : body.x + (1.0 / force) * cross(end.linear, end.angular);
  double* const y = s.rows.data() + (s.rows.size() - end.side.depth);  // after all rows
  double max_value = 0.0;
  for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    turns ? factor.moment_row(body.link, d, y) : factor.force_row(body.link, at, d, y);
    double answer = 0.0;
    for (std::uint32_t k = 0; k < end.side.depth; ++k) answer += y[k] * y[k];
    max_value = std::max(max_value, answer);
  }
  return (turns ? dot(end.angular, end.angular) : force) * max_value;
}

// Prepares one row of a joint. largest: the maximum response among the joint's rows of the same
// kind, forces or moments, and of their ends in any direction.
void prepare(const StepContext& s, JointPair& pair, double largest, JointRow& row) {
  const double min_value = s.bias_rate > 0.0 ? kMinInSubSteps : kMinAnswer;
  pair.floor = std::max(0.0, min_value * largest - row.inverse_mass);
  pair.answer = std::max(row.inverse_mass, kMinMoved * largest);
  row.softness = pair.loss * row.inverse_mass + pair.floor;
  if (pair.drives) prepare_drive(s, pair, row);
  const bool answers = row.inverse_mass > kNoAnswer;
  // A row that hardly responds cannot follow the curvature.
  if (answers) row.target -= pair.curve * row.inverse_mass / (row.inverse_mass + pair.floor);
  row.mass = answers ? 1.0 / (row.inverse_mass + row.softness) : 0.0;
  if (!answers) row.impulse = row.lower = row.upper = 0.0;
}
void prepare_joint(const StepContext& s, std::span<JointRow> rows) {
  double largest[2] = {};
  for (JointRow& row : rows) {
    const JointPair& pair = s.pairs[row.pair];
    row.inverse_mass = response_of(s, pair);
    double& max_value = largest[is_about_an_axis(pair) ? 1 : 0];
    max_value = std::max(
        {max_value, row.inverse_mass, largest_answer(s, pair.a) + largest_answer(s, pair.b)});
  }
  for (JointRow& row : rows) {
    JointPair& pair = s.pairs[row.pair];
    prepare(s, pair, largest[is_about_an_axis(pair) ? 1 : 0], row);
  }
}

}  // namespace

void prepare_link_rows(const StepContext& s) {
  std::size_t size = 0;
  for (ContactConstraint& c : s.contacts) {
    size += attach(s, c, c.a, c.side_a) + attach(s, c, c.b, c.side_b);
  }
  std::size_t deepest = 0;
  for (JointPair& pair : s.pairs) {
    size += attach(s, pair.a) + attach(s, pair.b);
    deepest = std::max<std::size_t>({deepest, pair.a.side.depth, pair.b.side.depth});
  }
  size += deepest;  // scratch
  if (s.rows.size() < size) s.rows.resize(size);
  double* y = s.rows.data();
  for (ContactConstraint& c : s.contacts) {
    y = fill(s, c, c.a, -1.0, c.side_a, y);
    y = fill(s, c, c.b, 1.0, c.side_b, y);
  }
  for (JointPair& pair : s.pairs) {
    y = fill(s, pair.a, y);
    y = fill(s, pair.b, y);
  }
  const std::size_t own = s.joints.size() - s.pairs.size();
  const std::span<JointRow> between = s.joints.subspan(own);
  for (std::size_t begin = 0, end = 0; begin < between.size(); begin = end) {
    const std::uint32_t joint = s.pairs[begin].joint;
    while (end < between.size() && s.pairs[end].joint == joint) ++end;
    prepare_joint(s, between.subspan(begin, end - begin));
  }
  for (JointRow& row : s.joints.first(own)) {
    const SolverArticulation& art = s.articulations[row.articulation];
    const detail::ImpulseFactor::JointRow of = art.factor->joint_row(row.dof);
    attach(art, row.dof, art.factor->depth_of_dof(row.dof), row.side);
    row.side.rows = of.y;
    row.inverse_mass = of.response;
    row.mass = 1.0 / (of.response + row.softness);
  }
}

}  // namespace vp::solve
