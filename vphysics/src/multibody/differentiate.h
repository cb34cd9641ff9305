// Derivatives of inverse dynamics, in the tree's frame (work.h).
//
// Velocity i moves the bodies of its own node n and of all nodes after it by the twist S_i. With
// the node before n called p, V and A (gravity as an acceleration on top) of the nodes, J of the
// bodies:
//
//   S1_i = ad_(V_p) S_i                                   so that dV/dq_i = ad_(S_i) V + S1_i
//   S2_i = ad_(A_p) S_i + ad_(V_p) S1_i                   dA/dq_i = ad_(S_i) A + ad_(S1_i) V + S2_i
//   Sv_i = S1_i + ad_(V_n) S_i                            dA/dv_i = ad_(S_i) V + Sv_i
//   B X  = -dad_V (J X) - dad_X (J V) - J ad_V X          of a body, linear in X
//
// Whatever is fixed to a moved body turns with it, so of the force F = J A - dad_V (J V) - load
//
//   dF/dq_i = -dad_(S_i) F + J S2_i + B S1_i,   dF/dv_i = B S_i + J Sv_i,   dF/da_i = J S_i.
//
// These are linear in J, B and F, whose sums over a node and all after it are J^, B^, F^
// (Composite). For a velocity j on the way from i to the root, all bodies that i moves hang on j
// too:
//
//   dtau_j/dq_i = <S_j, -dad_(S_i) F^ + J^ S2_i + B^ S1_i>   all sums of i's node
//   dtau_i/dq_j = <S2_j, J^ S_i> + <S1_j, B^* S_i>           what turns S_i turns F^ too, and drops
//   out dtau_j/dv_i = <S_j, B^ S_i + J^ Sv_i> dtau_i/dv_j = <S_j, B^* S_i> + <Sv_j, J^ S_i> M_ij =
//   <S_j, J^ S_i>
//
// If j and i are of one node, its columns turn with the body as well, for either order:
// dtau_j/dq_i has <ad_(S_i) S_j, F^> besides.
//
// With w the angular part of X, E = tr(I)/2 1 - I, h the first moment and p the linear momentum,
// B X = (-2 (V.w x E w + h x (V.v x w)), 2 w x p): twelve numbers, not thirty-six.
//
// A joint of one's own has columns that move in its link: D_ki = Ad_X dS_k/dq_i. Then
//   S1_i += d,  Sv_i += d + sum_l D_il v_l,  d = sum_k D_ki v_k
//   S2_i += ad_(V_p) d (by S1_i) + ad_(V_n) d + Ad_X d rate/dq_i + sum_k D_ki a_k
//   dtau_k/dq_i += <D_ki, F^>
#pragma once

#include "multibody/derivatives.h"

namespace vp::detail::slopes {

// --- from the roots outwards

template <class T>
Mat3T<T> velocity_product(const InertiaT<T>& J, const se3T<T>& V) {
  const Sym3T<T>& I = J.rotational();
  const Vec3T<T>& h = J.first_moment();
  const T half = T(0.5) * (I.xx + I.yy + I.zz);
  const auto column = [&](const Vec3T<T>& E, const Vec3T<T>& v_times) {
    return T(-2) * (cross(V.w, E) + cross(h, v_times));
  };
  const Vec3T<T>& v = V.v;
  return {column({half - I.xx, -I.xy, -I.zx}, {T(0), v.z, -v.y}),
          column({-I.xy, half - I.yy, -I.yz}, {-v.z, T(0), v.x}),
          column({-I.zx, -I.yz, half - I.zz}, {v.y, -v.x, T(0)})};
}

template <class T>
Composite<T> body_of(const InertiaT<T>& J, const se3T<T>& V, const se3T<T>& A) {
  const dse3T<T> momentum = J * V;
  return {J, J * A - dad(V, momentum), velocity_product(J, V), momentum.f};
}

template <class T>
struct Motion {
  se3T<T> V_before, A_before, V;
};

// S1, S2 and Sv of a user's joint, what its slopes add.
template <class T>
void add_slopes(const Node<T>& node, const UserSlopes<T>& slopes, Span<T> v, Span<T> a,
                const Motion<T>& m, std::size_t i, se3T<T>& S1, se3T<T>& S2, se3T<T>& Sv) {
  const auto n = static_cast<std::size_t>(node.dofs), first = static_cast<std::size_t>(node.v);
  se3T<T> d{}, own{}, accelerated = slopes.rate[i];
  for (std::size_t k = 0; k < n; ++k) {
    d = d + v[first + k] * slopes.S[n * k + i];
    own = own + v[first + k] * slopes.S[n * i + k];
    accelerated = accelerated + a[first + k] * slopes.S[n * k + i];
  }
  S1 = S1 + d;
  S2 = S2 + ad(m.V_before, d) + ad(m.V, d) + accelerated;
  Sv = Sv + d + own;
}

template <class T>
bool open_user(const Node<T>& node, const SE3T<T>& X, Span<T> q, Span<T> v, UserSlopes<T>& slopes,
               se3T<T>& rate) {
  const UserState at(node, q, v);
  if (!user_slopes(node, at, slopes)) return false;
  for (auto& S : slopes.S) S = Ad(X, S);
  for (auto& r : slopes.rate) r = Ad(X, r);
  rate = Ad(X, user_rate(node, at));
  return true;
}

// False where a user's joint does not say its slopes.
template <class T>
bool open_node(const Tree<T>& tree, const Work<T>& work, DerivativesWork<T>& memory, int number,
               Span<T> q, Span<T> v, Span<T> a, const se3T<T>& A_root) {
  const auto i = static_cast<std::size_t>(number);
  const Node<T>& node = tree.nodes[i];
  const bool root = node.parent == kWorld;
  const Motion<T> m = {root ? se3T<T>{} : velocity_of(work, node.parent),
                       root ? A_root : memory.A[static_cast<std::size_t>(node.parent)],
                       velocity_of(work, number)};
  se3T<T> A = m.A_before + ad(m.V_before, m.V), rate{};
  const UserSlopes<T>* slopes = nullptr;
  if (node.kind == NodeKind::user) {
    auto& own = memory.slopes[static_cast<std::size_t>(memory.slopes_of[i])];
    if (!open_user(node, pose_of(work, number), q, v, own, rate)) return false;
    A = A + rate;
    slopes = &own;
  }
  for (int k = 0; k < node.dofs; ++k) {
    const auto at = static_cast<std::size_t>(node.v + k);
    const se3T<T> S = column_of(tree, work, number, k);
    se3T<T> S1 = ad(m.V_before, S), S2 = ad(m.A_before, S) + ad(m.V_before, S1);
    se3T<T> Sv = S1 + ad(m.V, S);
    if (slopes != nullptr) {
      add_slopes(node, *slopes, v, a, m, static_cast<std::size_t>(k), S1, S2, Sv);
    }
    A = A + a[at] * S;
    memory.S.set(at, S);
    memory.S1.set(at, S1);
    memory.S2.set(at, S2);
    memory.Sv.set(at, Sv);
  }
  memory.A[i] = A;
  memory.composites[i] = body_of(inertia_of(tree, work, number), m.V, A);
  return true;
}

// The loads' forces on the links, from each node's F.
template <class T>
void take_loads(const Tree<T>& tree, const Work<T>& work, DerivativesWork<T>& memory,
                const LoadsT<T>& loads) {
  if (loads.external.empty()) return;
  for (std::size_t l = 0; l < tree.places.size(); ++l) {
    const auto& place = tree.places[l];
    if (place.node == kWorld) continue;
    dse3T<T>& F = memory.composites[static_cast<std::size_t>(place.node)].F;
    F = F - InvdAd(pose_of(work, place.node) * place.T_node_link, loads.external[l]);
  }
}

// --- from the leaves inwards

template <class T>
void add_up(const Tree<T>& tree, std::vector<Composite<T>>& composites) {
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    if (tree.nodes[i].parent == kWorld) continue;
    Composite<T>& sum = composites[static_cast<std::size_t>(tree.nodes[i].parent)];
    const Composite<T>& part = composites[i];
    sum = {sum.J + part.J, sum.F + part.F, sum.K + part.K, sum.p + part.p};
  }
}

// --- the matrices

// Numbers of velocity i that the loop along those before it multiplies with.
template <class T>
struct Factors {
  std::array<T, 6> F_q, F_v, F_a;  // dF^/dq_i, dF^/dv_i, dF^/da_i = J^ S_i
  std::array<T, 3> b;              // B^* S_i, which is an angular part alone
};
template <class T>
std::array<T, 6> numbers(const dse3T<T>& F) {
  return {F.m.x, F.m.y, F.m.z, F.f.x, F.f.y, F.f.z};
}
template <class T>
dse3T<T> B_times(const Composite<T>& c, const se3T<T>& X) {
  return {c.K * X.w, T(2) * cross(X.w, c.p)};
}
template <class T>
Factors<T> factors_of(const Composite<T>& c, const DerivativesWork<T>& memory, std::size_t i) {
  const se3T<T> S = memory.S.get(i), S1 = memory.S1.get(i), S2 = memory.S2.get(i);
  const Vec3T<T> b = transposed_times(c.K, S.w) + T(2) * cross(c.p, S.v);
  return {numbers(c.J * S2 + B_times(c, S1) - dad(S, c.F)),
          numbers(c.J * memory.Sv.get(i) + B_times(c, S)),
          numbers(c.J * S),
          {b.x, b.y, b.z}};
}

// What is filled along the velocities before one.
enum Along : std::size_t { kRowQ, kRowV, kRowA, kColumnQ, kColumnV };

template <class T>
void fill_run(DerivativesWork<T>& memory, const Factors<T>& f, std::size_t begin, std::size_t end) {
  // From an aligned place before it: what is not of the run, nobody reads.
  for (std::size_t j = begin / kPack<T> * kPack<T>; j < end; j += kPack<T>) {
    std::array<Lanes<T>, 5> sum{};
    for (std::size_t k = 0; k < 6; ++k) {
      const Lanes<T> S = memory.S.lanes(k, j), F_a(f.F_a[k]);
      sum[kRowQ] += memory.S2.lanes(k, j) * F_a;
      sum[kRowV] += memory.Sv.lanes(k, j) * F_a;
      sum[kRowA] += S * F_a;
      sum[kColumnQ] += S * Lanes<T>(f.F_q[k]);
      sum[kColumnV] += S * Lanes<T>(f.F_v[k]);
      if (k >= 3) continue;
      sum[kRowQ] += memory.S1.lanes(k, j) * Lanes<T>(f.b[k]);
      sum[kRowV] += S * Lanes<T>(f.b[k]);
    }
    for (std::size_t which = 0; which < 5; ++which) {
      store_lanes(memory.along[which].data() + j, sum[which]);
    }
  }
}

// Row and column i as far as velocity i: those before it, then itself.
template <class T>
void fill_velocity(const Node<T>& node, const Composite<T>& composite, DerivativesWork<T>& memory,
                   std::size_t i, const InverseMatrices<T>& out) {
  const Branch& branch = memory.branches[i];
  const Factors<T> f = factors_of(composite, memory, i);
  for (const Run& run : memory.way(branch)) {
    const auto begin = static_cast<std::size_t>(run.first), end = static_cast<std::size_t>(run.end);
    fill_run(memory, f, begin, end);
    for (std::size_t j = begin; j < end; ++j) {
      out.q(j, i) = memory.along[kColumnQ].data()[j];
      out.v(j, i) = memory.along[kColumnV].data()[j];
      out.a(j, i) = memory.along[kRowA].data()[j];
      out.q(i, j) = memory.along[kRowQ].data()[j];
      out.v(i, j) = memory.along[kRowV].data()[j];
      out.a(i, j) = memory.along[kRowA].data()[j];
    }
  }
  out.a(i, i) += node.armature;
  out.v(i, i) += node.damping;
}

// Between velocities of one node.
template <class T>
void turn_columns(const Node<T>& node, const dse3T<T>& F, const UserSlopes<T>* slopes,
                  const TwistArray<T>& columns, const MatrixView<T>& tau_q) {
  const auto first = static_cast<std::size_t>(node.v), dofs = static_cast<std::size_t>(node.dofs);
  for (std::size_t k = 0; k < dofs; ++k) {
    for (std::size_t i = 0; i < dofs; ++i) {
      T& tau = tau_q(first + k, first + i);
      if (k < i) tau += ad(columns.get(first + i), columns.get(first + k)) * F;
      if (slopes != nullptr) tau += slopes->S[dofs * k + i] * F;
    }
  }
}

// Adds to zeros in out, from what a call with the same q and v has left in the data's work. False
// where a joint of one's own does not say its slopes.
template <class T>
bool differentiate_kernel(const Tree<T>& tree, const Work<T>& work, DerivativesWork<T>& memory,
                          Span<T> q, Span<T> v, Span<T> a, const LoadsT<T>& loads,
                          const InverseMatrices<T>& out) {
  const se3T<T> A_root{{}, -loads.gravity};
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    if (!open_node(tree, work, memory, static_cast<int>(i), q, v, a, A_root)) {
      return false;
    }
  }
  take_loads(tree, work, memory, loads);
  add_up(tree, memory.composites);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const Node<T>& node = tree.nodes[i];
    const Composite<T>& composite = memory.composites[i];
    for (int k = 0; k < node.dofs; ++k) {
      fill_velocity(node, composite, memory, static_cast<std::size_t>(node.v + k), out);
    }
    if (node.dofs == 1 && node.kind != NodeKind::user) continue;
    const int slopes = memory.slopes_of[i];
    turn_columns(node, composite.F,
                 slopes < 0 ? nullptr : &memory.slopes[static_cast<std::size_t>(slopes)], memory.S,
                 out.q);
  }
  return true;
}

}  // namespace vp::detail::slopes
