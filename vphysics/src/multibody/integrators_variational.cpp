// A variational integrator for trees: the discrete Euler-Lagrange equations on the group.
//
// The action of a step from q0 to q1 is approximated by
//   L_d(q0, q1) = sum_i  h/2 <V_i, J_i V_i>  -  h/2 (U(q0) + U(q1)),
//   V_i = Log(Inv(T_i0) T_i1) / h,      T_i0, T_i1 the poses of link i at q0 and q1,
// with each link moving along a screw. Its derivatives are the momenta at the two ends. Setting the
// momenta of adjacent steps equal, and adding the impulses of forces without a potential (discrete
// d'Alembert), gives one step (q0, v0) -> (q1, v1):
//   M(q0) v0 = -D1 L_d(q0, q1) - h/2 f0                                  (1)  to solve for q1
//   M(q1) v1 =  D2 L_d(q0, q1) + h/2 f1                                  (2)
// The step is symplectic, since L_d generates it; reversible and of order 2, since L_d(q1, q0) of
// -h is -L_d(q0, q1); and it conserves momentum, since L_d is invariant under rigid motions of the
// world.
//
// The derivatives. Everything is in the tree's frame, fixed at its pose for q0, as in the other
// passes. Link i is displaced by D_i = T_i1 Inv(T_i0); then W_i = Log(D_i) = Ad_T_i0 (h V_i), and
// q1 = q0 [+] delta means, with S_i the columns at q0,
//   D_i = D_parent Exp(S_i delta_i)                                      base to tip
// Exp(W + d) = Exp(J_l(W) d) Exp(W) gives, for variations eta0, eta1 of the two poses,
//   d W_i = J_l^-1(W_i) (Ad_D_i eta1 - eta0),   eta0, eta1 in the frames of q0, carried by D_i
// so that the link has the same momentum at both ends, in the world:
//   pi_i = J_l^-1(W_i)^T  J_i W_i / h,   J_i the inertia in the tree's frame at q0
//   Pi_i = pi_i + sum of the children's Pi                               tip to base
//   -D1 L_d = <S_i, Pi_i> + h/2 dU/dq0,   D2 L_d = <Ad_D_i S_i, Pi_i> - h/2 dU/dq1
// (for a free body: the Moser-Veselov step). An armature adds armature * delta / h to both. A user
// joint has D_i = D_parent X(q1) Inv(X(q0)), with X its link's pose for a fixed parent, and at q1
// it uses its columns at q1.
//
// Solving (1): with its residual r and x = M^-1 r, from the factors of M(q0), delta += h x. M(q0) /
// h is the derivative of -D1 L_d up to O(h), so each iteration reduces the error by a factor of
// about h |v'| / |v|; three to five iterations of O(links).
//
// Source: Marsden, West, Discrete mechanics and variational integrators, Acta Numerica 10 (2001);
// Lee, Liu, Park, Srinivasa, A linear-time variational integrator for multibody systems, WAFR 2016.
// This is their discrete Newton-Euler recursion, in one frame instead of the links' frames.
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
// dAd_D F - F, accurate relative to the size of the difference.
template <class T>
dse3T<T> change_of(const Displacement<T>& D, const dse3T<T>& F) {
  const auto change = [&](const Vec3T<T>& x) {  // R^T x - x
    const Vec3T<T> ux = cross(D.u, x);
    return T(2) * (cross(D.u, ux) - D.c * ux);
  };
  const Vec3T<T> moved = cross(D.d, F.f);
  return {change(F.m) - (moved + change(moved)), change(F.f)};
}
// With the half angle h, A = sin(h) cos(h) / h and B = (sin(h) / h)^2 / 2 (so3.h).
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
// Precondition: a rotation by less than pi, c > 0.
template <class T>
se3T<T> screw_of(const Displacement<T>& D) {
  const T n2 = dot(D.u, D.u), n = std::sqrt(n2);
  // 2 asin(n) / n; below 1e-4 the omitted terms are less than 2^-53
  const T scale = n2 < T(1e-4) ? T(2) + n2 * (T(1.0 / 3) + n2 * (T(3.0 / 20) + n2 * T(5.0 / 56)))
                               : T(2) * arc_tangent(n, D.c) / n;
  const Vec3T<T> w = scale * D.u;
  return {w, left_jacobian_inverse(w) * D.d};
}

// --- user joints

template <class T>
struct UserPose {
  SE3T<T> X;
  std::array<se3T<T>, 6> S;
};
template <class T>
Vec3T<T> narrowed(const Vec3& a) {
  return {static_cast<T>(a.x), static_cast<T>(a.y), static_cast<T>(a.z)};
}
// Pose and columns at the coordinates q + delta.
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

  // Vectors of the step, in the memory that the other integrators use for their stages.
  std::vector<T>& static_force() { return work_.u_rate[0]; }  // dU/dq minus the external loads
  std::vector<T>& mean() { return work_.u_rate[1]; }          // delta / h
  std::vector<T>& momentum() { return work_.u_rate[2]; }      // M(q0) v0
  std::vector<T>& derivative() { return work_.u_rate[3]; }    // -D1 L_d, without U
  std::vector<T>& residual() { return work_.v_rate[0]; }      // of (1)
  std::vector<T>& correction() { return work_.v_rate[1]; }

  // At q0: inertias, columns, momentum, the factors of M, and the initial guess of delta from the
  // acceleration.
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
    accumulate_to_base();
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

  void accumulate_to_base() {
    for (std::size_t n = tree_.nodes.size(); n-- > 0;) {
      const int parent = tree_.nodes[n].parent;
      if (parent == kWorld) continue;
      dse3T<T>& sum = work_.nodes[static_cast<std::size_t>(parent)].momentum;
      sum = sum + work_.nodes[n].momentum;
    }
  }
  // <S, Pi>, plus the momentum of the armature at the joint velocities v.
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

  // Base to tip: D, pi and the energy. Tip to base: Pi. Then -D1 L_d. Returns false if a link
  // rotates by pi or more.
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
    accumulate_to_base();
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

  // Adds h/2 of all forces except the armature's to x.
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

  // The residual of (1) for the current delta.
  bool find_residual() {
    if (!find_derivative()) return false;
    residual() = momentum();
    add_impulse(q_, step_.t, residual());
    for (std::size_t i = 0; i < v_.size(); ++i) residual()[i] -= derivative()[i];
    return true;
  }
  // delta += h M^-1 r. Returns <r, M^-1 r>, twice the kinetic energy of the correction.
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

  // Solves (1) by corrections of delta, until they are below the tolerance, or at the level of
  // rounding and no longer decreasing.
  Expected<int> solve(const VariationalT<T>& options) {
    constexpr T kRounding = std::numeric_limits<T>::epsilon();  // of energies: squares of rates
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

  // Computes (2) as the left side of (1) plus its change over the step. The rounding error is then
  // relative to the change, and the residual of (1) is included.
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

  // Computes work_.v from the momenta. Momentum is conserved to rounding only if M v equals them as
  // closely as possible: one step of iterative refinement.
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
  T energy_ = 0;  // twice the kinetic energy of the mean motion
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
