// A variational integrator for trees: the discrete Euler-Lagrange equations on the group.
//
// The action of a step from q0 to q1 is approximated by
//   L_d(q0, q1) = sum_i  h/2 <V_i, J_i V_i>  -  h/2 (U(q0) + U(q1)),
//   V_i = Log(Inv(T_i0) T_i1) / h,      T_i0, T_i1 the poses of link i at q0 and q1,
// the links moving along a screw meanwhile. Its slopes are the momenta at the two ends; making
// those of neighbouring steps equal, and adding the impulses of forces without a potential
// (discrete d'Alembert), is one step (q0, v0) -> (q1, v1):
//   M(q0) v0 = -D1 L_d(q0, q1) - h/2 f0                                  (1)  to solve for q1
//   M(q1) v1 =  D2 L_d(q0, q1) + h/2 f1                                  (2)
// It is symplectic, since L_d generates it; reversible and of order 2, since L_d(q1, q0) of -h is
// -L_d(q0, q1); and it keeps momentum, since L_d does not change when the world is moved.
//
// The slopes. Everything is in the tree's frame, held fixed where it is at q0, as in the other
// passes. Link i is displaced by D_i = T_i1 Inv(T_i0); then W_i = Log(D_i) = Ad_T_i0 (h V_i), and
// q1 = q0 [+] delta means, S_i being its columns at q0,
//   D_i = D_parent Exp(S_i delta_i)                                      outwards
// Exp(W + d) = Exp(J_l(W) d) Exp(W) gives for variations eta0, eta1 of the two poses
//   d W_i = J_l^-1(W_i) (Ad_D_i eta1 - eta0),   eta0, eta1 in the frames of q0, carried by D_i
// so that both ends have one and the same momentum of the link, seen from the world:
//   pi_i = J_l^-1(W_i)^T  J_i W_i / h,   J_i the inertia in the tree's frame at q0
//   Pi_i = pi_i + sum of the children's Pi                               inwards
//   -D1 L_d = <S_i, Pi_i> + h/2 dU/dq0,   D2 L_d = <Ad_D_i S_i, Pi_i> - h/2 dU/dq1
// (a free body: the Moser-Veselov step). An armature adds armature * delta / h to both; a user's
// joint has D_i = D_parent X(q1) Inv(X(q0)) with X its link's pose, the parent standing still, and
// at q1 the columns it has there.
//
// Solving (1): with x = M^-1 r of its residual r, from the factors of M(q0), delta += h x. M(q0) /
// h is the slope of -D1 L_d up to O(h), so each round gains a factor of about h |v'| / |v|; three
// to five rounds of O(links).
//
// Source: Marsden, West, Discrete mechanics and variational integrators, Acta Numerica 10 (2001);
// Lee, Liu, Park, Srinivasa, A linear-time variational integrator for multibody systems, WAFR 2016,
// whose discrete Newton-Euler recursion in the links' frames this is, in one frame.
#include <algorithm>
#include <limits>

#include "multibody/integrators.h"
#include "multibody/kinematics.h"
#include "vphysics/multibody/configuration.h"

namespace vp {
namespace detail {
namespace {

// --- displacements

// R x = x + 2 c (u x x) + 2 u x (u x x)
template <class T>
Vec3T<T> rotated_by(const Displacement<T>& D, const Vec3T<T>& x) {
  const Vec3T<T> ux = cross(D.u, x);
  return x + T(2) * (D.c * ux + cross(D.u, ux));
}
template <class T>
Displacement<T> operator*(const Displacement<T>& A, const Displacement<T>& B) {
  return {A.c * B.u + B.c * A.u + cross(A.u, B.u), A.c * B.c - dot(A.u, B.u),
          A.d + rotated_by(A, B.d)};
}
// dAd_D F - F, with the precision of its own size.
template <class T>
dse3T<T> change_of(const Displacement<T>& D, const dse3T<T>& F) {
  const auto change = [&](const Vec3T<T>& x) {  // R^T x - x
    const Vec3T<T> ux = cross(D.u, x);
    return T(2) * (cross(D.u, ux) - D.c * ux);
  };
  const Vec3T<T> moved = cross(D.d, F.f);
  return {change(F.m) - (moved + change(moved)), change(F.f)};
}
// With h the half angle, A = sin(h) cos(h) / h and B = (sin(h) / h)^2 / 2 (so3.h).
template <class T>
Displacement<T> displacement(const se3T<T>& W) {
  const auto k = exp_coefficients(W.w);
  const T sinc = std::sqrt(T(2) * k.B);
  const Vec3T<T> wv = cross(W.w, W.v);
  return {(T(0.5) * sinc) * W.w, k.A / sinc, W.v + k.B * wv + coefficient_C(k) * cross(W.w, wv)};
}
template <class T>
Displacement<T> displacement(const SE3T<T>& A) {
  const QuaternionT<T> q = to_quaternion(A.rotation());
  return {{q.x, q.y, q.z}, q.w, A.position()};
}
template <class T>
SE3T<T> pose(const Displacement<T>& D) {
  return {from_quaternion(QuaternionT<T>{D.u.x, D.u.y, D.u.z, D.c}), D.d};
}
// Precondition: less than half a turn, c > 0.
template <class T>
se3T<T> screw_of(const Displacement<T>& D) {
  const T n2 = dot(D.u, D.u), n = std::sqrt(n2);
  // 2 asin(n) / n, of which below 1e-4 the terms left out are less than 2^-53
  const T scale = n2 < T(1e-4) ? T(2) + n2 * (T(1.0 / 3) + n2 * (T(3.0 / 20) + n2 * T(5.0 / 56)))
                               : T(2) * arc_tangent(n, D.c) / n;
  const Vec3T<T> w = scale * D.u;
  return {w, left_jacobian_inverse(w) * D.d};
}

// --- a user's joint

template <class T>
struct UserPose {
  SE3T<T> X;
  std::array<se3T<T>, 6> S;
};
template <class T>
Vec3T<T> narrowed(const Vec3& a) {
  return {static_cast<T>(a.x), static_cast<T>(a.y), static_cast<T>(a.z)};
}
// At its coordinates q + delta.
template <class T>
UserPose<T> user_pose(const Node<T>& node, Span<T> q, Span<T> delta) {
  const auto dofs = static_cast<std::size_t>(node.dofs);
  std::array<double, 6> at{}, still{};
  for (std::size_t k = 0; k < dofs; ++k) {
    at[k] = static_cast<double>(q[static_cast<std::size_t>(node.q) + k]);
    if (!delta.empty()) at[k] += static_cast<double>(delta[static_cast<std::size_t>(node.v) + k]);
  }
  SE3 X;
  std::array<se3, 6> S{};
  se3 rate;
  node.user->evaluate(std::span(at).first(dofs), std::span(still).first(dofs), X,
                      std::span(S).first(dofs), rate);
  const Mat3& R = X.rotation();
  UserPose<T> frame{{Mat3T<T>{narrowed<T>(R.cx), narrowed<T>(R.cy), narrowed<T>(R.cz)},
                     narrowed<T>(X.position())},
                    {}};
  for (std::size_t k = 0; k < dofs; ++k) frame.S[k] = {narrowed<T>(S[k].w), narrowed<T>(S[k].v)};
  return frame;
}

// --- the step

template <class T>
class VariationalStep {
 public:
  VariationalStep(const ModelT<T>& model, IntegratorWork<T>& work, const StepT<T>& step,
                  std::span<T> q, std::span<T> v)
      : model_(model), tree_(model.tree()), work_(work), step_(step), q_(q), v_(v) {}

  Expected<int> run(const VariationalT<T>& options) {
    const auto begun = begin();
    if (!begun) return tl::make_unexpected(begun.error());
    const Expected<int> rounds = solve(options);
    if (!rounds) return rounds;
    const auto ended = end();
    if (!ended) return tl::make_unexpected(ended.error());
    return rounds;
  }

 private:
  static constexpr const char* kName = "step_variational";

  // Vectors of the step, in the memory that the other integrators have for their stages.
  std::vector<T>& static_force() { return work_.u_rate[0]; }  // dU/dq less the external loads
  std::vector<T>& mean() { return work_.u_rate[1]; }          // delta / h
  std::vector<T>& momentum() { return work_.u_rate[2]; }      // M(q0) v0
  std::vector<T>& derivative() { return work_.u_rate[3]; }    // -D1 L_d, without U
  std::vector<T>& residual() { return work_.v_rate[0]; }      // of (1)
  std::vector<T>& correction() { return work_.v_rate[1]; }

  // At q0: inertias, columns, momentum, the factors of M, and a first delta from the acceleration.
  Expected<void> begin() {
    inverse_dynamics<T>(model_, work_.data, q_, work_.rest, work_.rest, step_.loads,
                        static_force());
    std::vector<T>& a = work_.v_rate[0];
    const auto done = acceleration<T>(model_, work_, q_, v_, step_.t, step_, a);
    if (!done) return done;
    read_links();
    for (std::size_t i = 0; i < v_.size(); ++i) {
      work_.u[i] = step_.h * (v_[i] + T(0.5) * step_.h * a[i]);
    }
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      VariationalNode<T>& node = work_.nodes[n];
      node.momentum = node.J * velocity_of(work_.data.work(), static_cast<int>(n));
    }
    add_inwards();
    project(v_, momentum());
    return {};
  }

  void read_links() {
    const Work<T>& work = work_.data.work();
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      const Node<T>& node = tree_.nodes[n];
      const int number = static_cast<int>(n);
      work_.nodes[n].J = inertia_of(tree_, work, number);
      for (int k = 0; k < node.dofs; ++k) {
        work_.S[static_cast<std::size_t>(node.v + k)] = column_of(tree_, work, number, k);
      }
      if (node.kind != NodeKind::user) continue;
      work_.nodes[n].link = pose_of(work, number);
      work_.nodes[n].joint = work_.nodes[n].link * Inv(user_pose<T>(node, q_, {}).X);
    }
  }

  void add_inwards() {
    for (std::size_t n = tree_.nodes.size(); n-- > 0;) {
      const int parent = tree_.nodes[n].parent;
      if (parent == kWorld) continue;
      dse3T<T>& sum = work_.nodes[static_cast<std::size_t>(parent)].momentum;
      sum = sum + work_.nodes[n].momentum;
    }
  }
  // <S, Pi>, and what the armature adds to it at the joints' velocities.
  void project(std::span<const T> v, std::span<T> out) const {
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      const Node<T>& node = tree_.nodes[n];
      for (int k = node.v; k < node.v + node.dofs; ++k) {
        const auto i = static_cast<std::size_t>(k);
        out[i] = work_.S[i] * work_.nodes[n].momentum + node.armature * v[i];
      }
    }
  }

  Displacement<T> of_joint(std::size_t n) const {
    const Node<T>& node = tree_.nodes[n];
    if (node.kind == NodeKind::user) {
      const VariationalNode<T>& frame = work_.nodes[n];
      return displacement(frame.joint * user_pose<T>(node, q_, work_.u).X * Inv(frame.link));
    }
    se3T<T> W{};
    for (int k = node.v; k < node.v + node.dofs; ++k) {
      const auto i = static_cast<std::size_t>(k);
      W = W + work_.u[i] * work_.S[i];
    }
    return displacement(W);
  }

  // D, pi and the energy outwards, Pi inwards, -D1 L_d. False where a link turns half a turn.
  bool find_derivative() {
    const T rate = T(1) / step_.h;
    energy_ = T(0);
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      const int parent = tree_.nodes[n].parent;
      VariationalNode<T>& node = work_.nodes[n];
      node.D = of_joint(n);
      if (parent != kWorld) node.D = work_.nodes[static_cast<std::size_t>(parent)].D * node.D;
      node.momentum = {};
      if (node.J == InertiaT<T>{}) continue;
      if (!(node.D.c > T(0))) return false;
      const se3T<T> W = screw_of(node.D);
      const dse3T<T> P = rate * (node.J * W);
      energy_ += rate * (W * P);
      node.momentum = left_jacobian_inverse(W).transposed_times(P);
    }
    add_inwards();
    for (std::size_t i = 0; i < v_.size(); ++i) mean()[i] = rate * work_.u[i];
    for (const Node<T>& node : tree_.nodes) {
      for (int k = node.v; k < node.v + node.dofs; ++k) {
        const T speed = mean()[static_cast<std::size_t>(k)];
        energy_ += node.armature * speed * speed;
      }
    }
    project(mean(), derivative());
    return true;
  }

  // h/2 of all forces without the armature's, added to x.
  void add_impulse(std::span<const T> q, T t, std::span<T> x) {
    const std::span<const T> tau = step_.forces.at(q, mean(), t, work_.tau);
    const T half = T(0.5) * step_.h;
    for (const Node<T>& node : tree_.nodes) {
      for (int k = node.v; k < node.v + node.dofs; ++k) {
        const auto i = static_cast<std::size_t>(k);
        x[i] += half * (tau[i] - static_force()[i] - node.damping * mean()[i]);
      }
    }
  }

  // What (1) is off by, for the present delta.
  bool find_residual() {
    if (!find_derivative()) return false;
    residual() = momentum();
    add_impulse(q_, step_.t, residual());
    for (std::size_t i = 0; i < v_.size(); ++i) residual()[i] -= derivative()[i];
    return true;
  }
  // delta += h M^-1 r; returns <r, M^-1 r>, twice the correction's kinetic energy.
  T correct() {
    correction() = residual();
    solve_mass<T>(model_, work_.data, correction());
    T energy = 0;
    for (std::size_t i = 0; i < v_.size(); ++i) {
      energy += correction()[i] * residual()[i];
      work_.u[i] += step_.h * correction()[i];
    }
    return energy;
  }

  // (1), by corrections of delta: until they are small, or small enough to be rounding's and no
  // longer shrinking.
  Expected<int> solve(const VariationalT<T>& options) {
    constexpr T kRounding = std::numeric_limits<T>::epsilon();  // of energies: its root of rates
    bool close = false;
    T before = std::numeric_limits<T>::infinity();
    for (int iteration = 0; iteration <= options.max_iterations; ++iteration) {
      if (!find_residual()) {
        return not_converged(kName, "a link turns half a turn in the step; take shorter steps");
      }
      if (close) return iteration;
      const T missing = correct();
      if (!std::isfinite(missing)) break;
      close = missing <= options.tolerance * options.tolerance * energy_ ||
              (missing <= kRounding * energy_ && missing > T(0.25) * before);
      before = missing;
    }
    return not_converged(kName,
                         "the step's equation has no solution near; take shorter steps, or softer "
                         "dampers");
  }

  // (2), as what (1) has on its left side and how that changes over the step: rounding is then that
  // of the change, and what (1) is off by is not lost.
  Expected<void> end() {
    integrate<T>(model_, q_, work_.u, work_.q);
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      const Node<T>& node = tree_.nodes[n];
      const VariationalNode<T>& own = work_.nodes[n];
      const bool user = node.kind == NodeKind::user;
      UserPose<T> frame{};
      if (user) frame = user_pose<T>(node, q_, work_.u);
      const dse3T<T> Pi = user ? dAd(pose(own.D) * own.link, own.momentum) : dse3T<T>{};
      const dse3T<T> change = change_of(own.D, own.momentum);
      for (int k = 0; k < node.dofs; ++k) {
        const auto i = static_cast<std::size_t>(node.v + k);
        const se3T<T>& S = work_.S[i];
        const T grown =
            user ? frame.S[static_cast<std::size_t>(k)] * Pi - S * own.momentum : S * change;
        work_.v[i] = derivative()[i] + residual()[i] + grown;
      }
    }
    inverse_dynamics<T>(model_, work_.data, work_.q, work_.rest, work_.rest, step_.loads,
                        static_force());
    add_impulse(work_.q, step_.t + step_.h, work_.v);
    const auto done = factor_mass<T>(model_, work_.data, work_.q);
    if (!done) return done;
    to_velocities();
    std::copy(work_.q.begin(), work_.q.end(), q_.begin());
    std::copy(work_.v.begin(), work_.v.end(), v_.begin());
    return {};
  }

  // work_.v from momenta, which are kept to rounding only if M v is them as nearly as it can be:
  // M^-1 of what is missing is added once.
  void to_velocities() {
    correction() = work_.v;
    solve_mass<T>(model_, work_.data, correction());
    inverse_dynamics<T>(model_, work_.data, work_.q, work_.rest, correction(),
                        {.gravity = {T(0), T(0), T(0)}}, work_.tau);
    for (std::size_t i = 0; i < v_.size(); ++i) residual()[i] = work_.v[i] - work_.tau[i];
    solve_mass<T>(model_, work_.data, residual());
    for (std::size_t i = 0; i < v_.size(); ++i) work_.v[i] = correction()[i] + residual()[i];
  }

  const ModelT<T>& model_;
  const Tree<T>& tree_;
  IntegratorWork<T>& work_;
  const StepT<T>& step_;
  std::span<T> q_, v_;
  T energy_ = 0;  // kinetic, twice, of the mean motion
};

}  // namespace
}  // namespace detail

template <class T>
Expected<int> step_variational(const ModelT<T>& model, IntegratorDataT<T>& data, std::span<T> q,
                               std::span<T> v, const std::type_identity_t<StepT<T>>& step,
                               const std::type_identity_t<VariationalT<T>>& options) {
  const char* call = "step_variational";
  const auto checked = detail::check_step<T>(call, model, q, v, step);
  if (!checked) return tl::make_unexpected(checked.error());
  if (!detail::positive_and_finite(options.tolerance) || options.max_iterations < 1) {
    return detail::invalid_argument(call,
                                    "the tolerance must be positive, and one iteration allowed");
  }
  return detail::VariationalStep<T>(model, data.work(), step, q, v).run(options);
}

#define VP_VARIATIONAL(T)                                                                      \
  template Expected<int> step_variational(const ModelT<T>&, IntegratorDataT<T>&, std::span<T>, \
                                          std::span<T>, const std::type_identity_t<StepT<T>>&, \
                                          const std::type_identity_t<VariationalT<T>>&);
VP_VARIATIONAL(double)
VP_VARIATIONAL(float)

}  // namespace vp
