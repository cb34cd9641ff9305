#include "solve/joint_block.h"

#include <algorithm>
#include <cmath>

#include "solve/row_vector.h"

namespace vp::solve {
namespace {

// Bounded rows are few; their sweeps are on the Schur complement and need no bodies.
constexpr int kBoundedSweeps = 4;
// A drive whose spring is softer than this, in (sub-steps times natural frequency)^2, is integrated
// so that it neither loses nor gains energy; a stiffer one ever more implicitly. Sixteen such
// springs on one body are still stable: 4 is the limit.
constexpr double kExplicit = 0.25;
// A pivot below this share of its row's own K is of a row that others hold already.
constexpr double kDependent = 1e-9;
constexpr double kSettled = 1e-4;     // of the load: the change of a round that is enough
constexpr double kFastestStop = 3.0;  // out of a limit [m/s or rad/s]

struct Velocities {
  Vec3 v_a, w_a, v_b, w_b;
};
Velocities velocities(const JointBlock& joint, const BodyRow* rows) {
  const float *a = rows[joint.a].velocity, *b = rows[joint.b].velocity;
  return {vector_of(a), vector_of(a + 3), vector_of(b), vector_of(b + 3)};
}
double rate(const Twelve& J, const Velocities& v) {
  return dot(J.linear_a, v.v_a) + dot(J.angular_a, v.w_a) + dot(J.linear_b, v.v_b) +
         dot(J.angular_b, v.w_b);
}
double product(const Twelve& a, const Twelve& b) {
  return dot(a.linear_a, b.linear_a) + dot(a.angular_a, b.angular_a) + dot(a.linear_b, b.linear_b) +
         dot(a.angular_b, b.angular_b);
}

void add(float* velocity, const Vec3& v) {
  vp::put(velocity, vector_of(velocity) + v);
}
void push(const JointBlock& joint, BodyRow* rows, const double* change) {
  Velocities sum{};
  for (int i = 0; i < joint.count; ++i) {
    const Twelve& answer = joint.rows[i].answer;
    sum.v_a += change[i] * answer.linear_a;
    sum.w_a += change[i] * answer.angular_a;
    sum.v_b += change[i] * answer.linear_b;
    sum.w_b += change[i] * answer.angular_b;
  }
  add(rows[joint.a].velocity, sum.v_a);
  add(rows[joint.a].velocity + 3, sum.w_a);
  add(rows[joint.b].velocity, sum.v_b);
  add(rows[joint.b].velocity + 3, sum.w_b);
}

// The change of a drive's impulse at the speed u, with K what an impulse does to that speed.
double drive_change(const JointRow6& row, double u, double K, double h) {
  if (!(row.most > row.least)) return 0.0;
  const double s = h * h * row.stiffness * K;
  const double implicit = s > kExplicit ? 1.0 - kExplicit / s : 0.0;
  const double g = h * row.damping + implicit * h * h * row.stiffness;
  const double error = row.residual - row.position;
  const double wanted = row.impulse - (h * row.stiffness * error + g * u -
                                       h * row.damping * row.speed + row.impulse) /
                                          (1.0 + g * K);
  return std::clamp(wanted, row.least, row.most) - row.impulse;
}

// The same of what holds within bounds. Where these let it go one way only, a gap may close.
double hold_change(const JointRow6& row, double u, double K, double h, bool pushes) {
  if (!(K > 0.0)) return 0.0;
  const bool open =
      (row.least >= 0.0 && row.residual > 0.0) || (row.most <= 0.0 && row.residual < 0.0);
  double wanted = row.impulse;
  if (open) {
    wanted -= (u + row.residual / h) / K;
  } else if (pushes) {
    wanted -= (u + row.rate * row.residual + row.loss * K * row.impulse) / (K * (1.0 + row.loss));
  } else if (row.relaxes) {
    wanted -= u / K;
  }
  return std::clamp(wanted, row.least, row.most) - row.impulse;
}

// The same of the limits. An open one lets the gap close; one that is passed is pushed out.
double stop_change(const JointRow6& row, double u, double K, double h, bool pushes) {
  const double below = row.residual - row.lower, above = row.upper - row.residual;
  const bool at_lower = below <= above;
  const double gap = at_lower ? below : above, side = at_lower ? 1.0 : -1.0;
  const double p = side * row.stop, speed = side * u;
  if (p < 0.0) return -row.stop;  // of the other limit
  if (!(gap < 0.5 * kNowhere)) return -row.stop;
  const double mass = K > 0.0 ? 1.0 / K : 0.0;
  double next = 0.0;
  if (gap > 0.0) {
    next = p - mass * (speed + gap / h);
    if (!pushes) next = std::min(next, p);  // what closes next is the next sub-step's affair
  } else if (pushes) {
    const double push = std::max(row.rate * gap, -kFastestStop);
    next = p - (mass * (speed + push) + row.loss * p) / (1.0 + row.loss);
  } else {
    next = row.relaxes ? p - mass * speed : p;
  }
  return side * (std::max(next, 0.0) - p);
}

// On entry u: of held rows what is to become zero, of bounded ones their speeds. Returns in change
// the changes of impulses.
void solve_block(JointBlock& joint, double* u, double* change, double h, bool pushes) {
  const auto& L = joint.factor;
  const int n = joint.count, held = joint.held;
  for (int j = 0; j < held; ++j) {
    for (int i = j + 1; i < n; ++i) u[i] -= L[i][j] * u[j];
  }
  std::fill_n(change, n, 0.0);
  for (int sweep = 0; sweep < (n > held + 1 ? kBoundedSweeps : 1); ++sweep) {
    for (int i = held; i < n; ++i) {
      JointRow6& row = joint.rows[i];
      const auto felt = [&](int k) { return L[std::max(i, k)][std::min(i, k)]; };
      const auto give = [&](double p) {
        change[i] += p;
        for (int k = held; k < n; ++k) u[k] += felt(k) * p;
      };
      // Springs are as implicit as they are: relaxing them would count them twice.
      if (row.bounded_hold || pushes || row.stiffness == 0.0) {
        const double by_drive = row.bounded_hold ? hold_change(row, u[i], L[i][i], h, pushes)
                                                 : drive_change(row, u[i], L[i][i], h);
        row.impulse += by_drive;
        give(by_drive);
      }
      const double by_stop = stop_change(row, u[i], L[i][i], h, pushes);
      row.stop += by_stop;
      give(by_stop);
    }
  }
  for (int i = held - 1; i >= 0; --i) {
    change[i] = -L[i][i] * u[i];
    for (int k = i + 1; k < n; ++k) change[i] -= L[k][i] * change[k];
    joint.rows[i].impulse += change[i];
  }
}

}  // namespace

void prepare(JointBlock& joint, const BodyRow* rows) {
  const auto inertia = [](const BodyRow& row) {
    const float* f = row.inertia;
    const auto at = [f](int i) { return static_cast<double>(f[i]); };
    return Sym3{at(0), at(1), at(2), at(3), at(4), at(5)};
  };
  const BodyRow &a = rows[joint.a], &b = rows[joint.b];
  const double m_a = static_cast<double>(a.velocity[kInverseMass]);
  const double m_b = static_cast<double>(b.velocity[kInverseMass]);
  const Sym3 I_a = inertia(a), I_b = inertia(b);
  auto& K = joint.factor;
  const int n = joint.count, held = joint.held;
  for (int i = 0; i < n; ++i) {
    JointRow6& row = joint.rows[i];
    const Twelve& J = row.jacobian;
    row.answer = {m_a * J.linear_a, I_a * J.angular_a, m_b * J.linear_b, I_b * J.angular_b};
    for (int j = 0; j <= i; ++j) K[i][j] = product(J, joint.rows[j].answer);
    row.own = K[i][i];
    if (i < held) K[i][i] *= 1.0 + row.loss;
  }
  // Below the diagonal L of the held columns; the rest becomes the Schur complement.
  for (int j = 0; j < held; ++j) {
    const double inverse = K[j][j] > kDependent * joint.rows[j].own ? 1.0 / K[j][j] : 0.0;
    for (int i = j + 1; i < n; ++i) {
      const double l = K[i][j] * inverse;
      for (int k = j + 1; k <= i; ++k) K[i][k] -= l * K[k][j];
    }
    for (int i = j + 1; i < n; ++i) K[i][j] *= inverse;
    K[j][j] = inverse;
  }
}

void warm_start(const JointBlock& joint, BodyRow* rows) {
  double p[kJointRows];
  for (int i = 0; i < joint.count; ++i) p[i] = joint.rows[i].impulse + joint.rows[i].stop;
  push(joint, rows, p);
}

void solve(JointBlock& joint, BodyRow* rows, double h) {
  const Velocities v = velocities(joint, rows);
  double u[kJointRows], change[kJointRows];
  for (int i = 0; i < joint.count; ++i) {
    const JointRow6& row = joint.rows[i];
    u[i] = rate(row.jacobian, v);
    if (i >= joint.held) continue;
    u[i] += row.rate * row.residual + row.loss * row.own * row.impulse;
  }
  solve_block(joint, u, change, h, true);
  push(joint, rows, change);
  double moved = 0.0, load = 0.0;  // by what they do: rows are of forces and of moments
  for (int i = 0; i < joint.count; ++i) {
    const JointRow6& row = joint.rows[i];
    const double p = row.impulse + row.stop;
    moved += change[i] * change[i] * row.own;
    load += p * p * row.own;
  }
  joint.settled = moved <= kSettled * kSettled * load;
}

void relax(JointBlock& joint, BodyRow* rows, double h) {
  const Velocities v = velocities(joint, rows);
  double u[kJointRows], change[kJointRows];
  for (int i = 0; i < joint.count; ++i) {
    const JointRow6& row = joint.rows[i];
    u[i] = i >= joint.held || row.relaxes ? rate(row.jacobian, v) : 0.0;
  }
  solve_block(joint, u, change, h, false);
  push(joint, rows, change);
}

}  // namespace vp::solve
