// Derivatives of inverse dynamics, in the tree's frame (work.h).
//
// Velocity i moves the bodies of its own node n and of all descendants by the twist S_i. Let p be
// the parent of n, V and A (including gravity) the twists and accelerations of the nodes, J the
// inertias of the bodies:
//
//   S1_i = ad_(V_p) S_i                                   so that dV/dq_i = ad_(S_i) V + S1_i
//   S2_i = ad_(A_p) S_i + ad_(V_p) S1_i                   dA/dq_i = ad_(S_i) A + ad_(S1_i) V + S2_i
//   Sv_i = S1_i + ad_(V_n) S_i                            dA/dv_i = ad_(S_i) V + Sv_i
//   B X  = -dad_V (J X) - dad_X (J V) - J ad_V X          of a body, linear in X
//
// Quantities fixed to a moved body rotate with it, so the force F = J A - dad_V (J V) - load has
//
//   dF/dq_i = -dad_(S_i) F + J S2_i + B S1_i,   dF/dv_i = B S_i + J Sv_i,   dF/da_i = J S_i.
//
// These are linear in J, B and F, whose sums over a node's subtree are J^, B^, F^ (VelocityField).
// For a velocity j on the path from i to the root, all bodies that i moves are descendants of j
// too:
//
//   dtau_j/dq_i = <S_j, -dad_(S_i) F^ + J^ S2_i + B^ S1_i>   sums over the subtree of i's node
//   dtau_i/dq_j = <S2_j, J^ S_i> + <S1_j, B^* S_i>           S_i and F^ rotate together: no term
//   dtau_j/dv_i = <S_j, B^ S_i + J^ Sv_i>
//   dtau_i/dv_j = <S_j, B^* S_i> + <Sv_j, J^ S_i>
//   M_ij        = <S_j, J^ S_i>
//
// If j and i belong to one node, its columns rotate with the body as well, in either order:
// dtau_j/dq_i has the additional term <ad_(S_i) S_j, F^>.
//
// With w the angular part of X, E = tr(I)/2 1 - I, h the first moment and p the linear momentum, B
// X = (-2 (V.w x E w + h x (V.v x w)), 2 w x p): twelve numbers instead of thirty-six.
//
// A user joint has columns that move in its link: D_ki = Ad_X dS_k/dq_i. Then
//   S1_i += d,  Sv_i += d + sum_l D_il v_l,  d = sum_k D_ki v_k
//   S2_i += ad_(V_p) d (by S1_i) + ad_(V_n) d + Ad_X d rate/dq_i + sum_k D_ki a_k
//   dtau_k/dq_i += <D_ki, F^>
#pragma once

#include "multibody/base_to_tip.h"
#include "multibody/derivatives.h"

namespace vp::detail::derivatives {

// --- base to tip

template <class T>
Mat3T<T> velocity_product(const InertiaT<T>& J, const se3T<T>& V) {
  const Sym3T<T>& I = J.rotational();
  const Vec3T<T>& h = J.first_moment();
  const T zero(0), half = T(0.5) * (I.xx + I.yy + I.zz);
  const auto column = [&](const Vec3T<T>& E, const Vec3T<T>& v_times) {
    return T(-2) * (cross(V.w, E) + cross(h, v_times));
  };
  const Vec3T<T>& v = V.v;
  return {column({half - I.xx, -I.xy, -I.zx}, {zero, v.z, -v.y}),
          column({-I.xy, half - I.yy, -I.yz}, {-v.z, zero, v.x}),
          column({-I.zx, -I.yz, half - I.zz}, {v.y, -v.x, zero})};
}

template <class T>
using Records = Fields<T, Wide<T>>;

template <class N, class F>
InertiaT<N> inertia_at(const F& fields) {
  return {fields.get(kCompositeMass), fields.vec(kCompositeMoment), fields.sym(kCompositeInertia)};
}

// Computes, for a group of velocities, S1, S2 and Sv, and F, K and p of the bodies.
template <class T>
VP_FLATTEN void begin_group(const Records<T>& fields, const Records<T>& joints) {
  using N = Wide<T>;
  const se3T<N> S = fields.twist(kColumnS), V_p = joints.twist(kParentV);
  const se3T<N> V = joints.twist(kNodeV);
  const se3T<N> S1 = ad(V_p, S);
  fields.set(kColumnS1, S1);
  fields.set(kColumnS2, ad(joints.twist(kParentA), S) + ad(V_p, S1));
  fields.set(kColumnSv, S1 + ad(V, S));
  const InertiaT<N> J = inertia_at<N>(fields);
  const dse3T<N> momentum = J * V;
  fields.set(kCompositeF, J * joints.twist(kNodeA) - dad(V, momentum));
  const Mat3T<N> K = velocity_product(J, V);
  fields.set(kCompositeK, K.cx);
  fields.set(kCompositeK + 3, K.cy);
  fields.set(kCompositeK + 6, K.cz);
  fields.set(kCompositeP, momentum.f);
}

// Adds the derivatives of a user joint to S1, S2 and Sv of its column i.
template <class T>
VP_NOINLINE void add_derivatives(const Node<base_t<T>>& node, const UserDerivatives<T>& derivatives,
                                 Span<T> v, Span<T> a, std::size_t i, const Fields<T, T>& fields,
                                 const Fields<T, T>& joints) {
  const auto n = static_cast<std::size_t>(node.dofs), first = static_cast<std::size_t>(node.v);
  se3T<T> d{}, self{}, accelerated = derivatives.rate[i];
  for (std::size_t k = 0; k < n; ++k) {
    d = d + v[first + k] * derivatives.S[n * k + i];
    self = self + v[first + k] * derivatives.S[n * i + k];
    accelerated = accelerated + a[first + k] * derivatives.S[n * k + i];
  }
  const se3T<T> turned = ad(joints.twist(kParentV), d) + ad(joints.twist(kNodeV), d);
  fields.set(kColumnS1, fields.twist(kColumnS1) + d);
  fields.set(kColumnS2, fields.twist(kColumnS2) + turned + accelerated);
  fields.set(kColumnSv, fields.twist(kColumnSv) + d + self);
}

// Returns false if the joint does not provide its derivatives.
template <class T>
VP_NOINLINE bool open_user(const Node<base_t<T>>& node, const SE3T<T>& X, Span<T> q, Span<T> v,
                           UserDerivatives<T>& derivatives) {
  for (int lane = 0; lane < kLanesOf<T>; ++lane) {
    if (!user_derivatives<T>(node, UserState(node, q, v, lane), lane, derivatives)) return false;
  }
  for (auto& S : derivatives.S) S = Ad(X, S);
  for (auto& r : derivatives.rate) r = Ad(X, r);
  return true;
}

template <class T>
struct State {
  const Tree<base_t<T>>& tree;
  Work<T>& work;
  Span<T> q, v, a;
  se3T<T> A_root;
};

template <class T>
se3T<T> velocity_before(const State<T>& state, const Node<base_t<T>>& node) {
  return node.parent == kWorld ? se3T<T>{} : velocity_of(state.work, node.parent);
}
template <class T>
se3T<T> acceleration_before(const State<T>& state, const DerivativesWork<T>& memory,
                            const Node<base_t<T>>& node) {
  return node.parent == kWorld ? state.A_root : memory.A[static_cast<std::size_t>(node.parent)];
}

// Prepares a node, at its first velocity. Returns false if a user joint does not provide its
// derivatives.
template <class T>
bool begin_node(const State<T>& state, DerivativesWork<T>& memory, int number) {
  const auto n = static_cast<std::size_t>(number);
  const Node<base_t<T>>& node = state.tree.nodes[n];
  se3T<T> A = acceleration_before(state, memory, node) +
              ad(velocity_before(state, node), velocity_of(state.work, number));
  if (node.kind == NodeKind::user) {
    UserDerivatives<T>& derivatives =
        memory.derivatives[static_cast<std::size_t>(memory.derivatives_of[n])];
    if (!open_user(node, pose_of(state.work, number), state.q, state.v, derivatives)) return false;
    A = A + state.work.columns[static_cast<std::size_t>(state.work.columns_of[n])].rate;
  }
  for (int k = 0; k < node.dofs; ++k) {
    const T& a = state.a[static_cast<std::size_t>(node.v + k)];
    A = A + a * column_of(state.tree, state.work, number, k);
  }
  memory.A[n] = A;
  return true;
}

// Writes the bodies' inertias to the fields of their slots.
template <class T>
VP_FLATTEN void place_bodies(const Tree<base_t<T>>& tree, Work<T>& work) {
  for (int g = 0; g < static_cast<int>(layout_of<T>(tree).groups.size()); ++g) {
    const auto fields = work.group(g);
    const Body<Wide<T>> body = BodyInTree<T>()(group_constants<T>(tree, g), fields.pose(kX));
    const Vec3T<Wide<T>> h = body.mass * body.centre;
    fields.set(kH, h);
    fields.set(kI, rotational(body, h));
  }
}

// Gathers the inputs of begin_group.
template <class T>
void gather(const State<T>& state, DerivativesWork<T>& memory, const Branch& branch,
            const Fields<T, T>& fields, const Fields<T, T>& joints) {
  const auto n = static_cast<std::size_t>(branch.node);
  const Node<base_t<T>>& node = state.tree.nodes[n];
  fields.set(kColumnS, column_of(state.tree, state.work, branch.node, branch.column));
  joints.set(kParentV, velocity_before(state, node));
  joints.set(kParentA, acceleration_before(state, memory, node));
  joints.set(kNodeV, velocity_of(state.work, branch.node));
  joints.set(kNodeA, memory.A[n]);
  if (!branch.last) {
    for (int f = kCompositeMass; f < kCompositeF; ++f) fields.set(f, T(0));
    return;
  }
  const auto body = state.work.slot(node.body_slot());
  fields.set(kCompositeMass, constants_of<T>(state.tree, node.body_slot()).get(kMass));
  fields.set(kCompositeMoment, body.vec(kH));
  fields.set(kCompositeInertia, body.sym(kI));
}

// Returns false if a user joint does not provide its derivatives.
template <class T>
bool open(const State<T>& state, DerivativesWork<T>& memory) {
  const int velocities = static_cast<int>(memory.branches.size());
  place_bodies(state.tree, state.work);
  for (int g = 0; g < memory.groups(); ++g) {
    const int first = g * kSlots<T>, count = std::min(kSlots<T>, velocities - first);
    for (int k = 0; k < count; ++k) {
      const Branch& branch = memory.branches[static_cast<std::size_t>(first + k)];
      if (branch.column == 0 && !begin_node(state, memory, branch.node)) return false;
      gather(state, memory, branch, memory.velocity(first + k), memory.lane(k));
    }
    begin_group<T>(memory.group(g), memory.lanes());
    for (int k = 0; k < count; ++k) {
      const Branch& branch = memory.branches[static_cast<std::size_t>(first + k)];
      const int derivatives = memory.derivatives_of[static_cast<std::size_t>(branch.node)];
      if (derivatives < 0) continue;
      add_derivatives<T>(state.tree.nodes[static_cast<std::size_t>(branch.node)],
                         memory.derivatives[static_cast<std::size_t>(derivatives)], state.v,
                         state.a, static_cast<std::size_t>(branch.column),
                         memory.velocity(first + k), memory.lane(k));
    }
  }
  return true;
}

// Subtracts the external loads on the links from F of their nodes' bodies.
template <class T>
void take_loads(const State<T>& state, DerivativesWork<T>& memory, Span<dse3T<T>> external) {
  for (std::size_t l = 0; l < external.size(); ++l) {
    const auto& frame = state.tree.frames[l];
    if (frame.node == kWorld) continue;
    const auto& node = state.tree.nodes[static_cast<std::size_t>(frame.node)];
    const auto body = memory.velocity(node.v + node.dofs - 1);
    const SE3T<T> X = pose_of(state.work, frame.node) * wide<T>(frame.T_node_link);
    body.set(kCompositeF, body.wrench(kCompositeF) - InvdAd(X, external[l]));
  }
}

// --- tip to base

template <class T>
void add_to_parent(DerivativesWork<T>& memory, int i) {
  const int parent = memory.branches[static_cast<std::size_t>(i)].parent;
  if (parent < 0) return;
  const auto part = memory.velocity(i), sum = memory.velocity(parent);
  for (int f = kCompositeMass; f < kCompositeEnd; ++f) sum.set(f, sum.get(f) + part.get(f));
}

// dF^/dq_i, dF^/dv_i, dF^/da_i = J^ S_i, and B^* S_i, which has only an angular part.
template <class T>
VP_FLATTEN void close_group(const Records<T>& fields, const Records<T>& forces) {
  using N = Wide<T>;
  const InertiaT<N> J = inertia_at<N>(fields);
  const Mat3T<N> K = fields.mat(kCompositeK);
  const Vec3T<N> p = fields.vec(kCompositeP);
  const auto B_times = [&](const se3T<N>& X) { return dse3T<N>{K * X.w, N(2) * cross(X.w, p)}; };
  const se3T<N> S = fields.twist(kColumnS);
  forces.set(kForceQ, J * fields.twist(kColumnS2) + B_times(fields.twist(kColumnS1)) -
                          dad(S, fields.wrench(kCompositeF)));
  forces.set(kForceV, J * fields.twist(kColumnSv) + B_times(S));
  forces.set(kForceA, J * S);
  forces.set(kTransposed, transposed_times(K, S.w) + N(2) * cross(p, S.v));
}

// --- the matrices

// Sums of a group of velocities j on the path: dtau_i/dq_j, dtau_i/dv_j, M_ij or L_ij, dtau_j/dq_i,
// dtau_j/dv_i.
enum PathSum : int { kRowQ, kRowV, kRowA, kColumnQ, kColumnV, kPathSums };

// forces: of velocity i; W: J^ S_i, or the wrench W_i of L.
template <class T>
VP_FLATTEN void sum_along(const Records<T>& along, const Fields<T, T>& forces, const T* W,
                          Wide<T> (&sum)[kPathSums]) {
  using N = Wide<T>;
  const N zero(base_t<T>(0));
  N row_q = zero, row_v = zero, row_a = zero, column_q = zero, column_v = zero;
  for (int k = 0; k < 6; ++k) {
    const N S = along.get(kColumnS + k), F_a(forces.get(kForceA + k));
    row_q += along.get(kColumnS2 + k) * F_a;
    row_v += along.get(kColumnSv + k) * F_a;
    row_a += S * N(W[k]);
    column_q += S * N(forces.get(kForceQ + k));
    column_v += S * N(forces.get(kForceV + k));
    if (k >= 3) continue;
    const N b(forces.get(kTransposed + k));
    row_q += along.get(kColumnS1 + k) * b;
    row_v += S * b;
  }
  sum[kRowQ] = row_q;
  sum[kRowV] = row_v;
  sum[kRowA] = row_a;
  sum[kColumnQ] = column_q;
  sum[kColumnV] = column_v;
}

template <class T>
void put_column(const MatrixView<T>& to, std::size_t first_row, std::size_t column,
                const Wide<T>& x, int begin, int end) {
  if constexpr (kSlots<T> == 1) {
    to(first_row, column) = x;
  } else {
    alignas(64) T numbers[kSlots<T>];
    store(numbers, x);
    for (int k = begin; k < end; ++k)
      to(first_row + static_cast<std::size_t>(k), column) = numbers[k];
  }
}

// Fills row and column i up to velocity i: the velocities on its path, then itself.
template <class T>
void fill_velocity(DerivativesWork<T>& memory, int number, const Fields<T, T>& forces, const T* W,
                   bool symmetric, const InverseMatrices<T>& out) {
  const auto i = static_cast<std::size_t>(number);
  Wide<T> sum[kPathSums];
  for (const Run& run : memory.path(memory.branches[i])) {
    for (int g = run.first / kSlots<T>; g * kSlots<T> < run.end; ++g) {
      const int first = g * kSlots<T>;
      const int begin = std::max(run.first - first, 0), end = std::min(run.end - first, kSlots<T>);
      const auto at = static_cast<std::size_t>(first), group = static_cast<std::size_t>(g);
      sum_along<T>(memory.group(g), forces, W, sum);
      put_column<T>(out.q, at, i, sum[kColumnQ], begin, end);
      put_column<T>(out.v, at, i, sum[kColumnV], begin, end);
      if (symmetric) put_column<T>(out.a, at, i, sum[kRowA], begin, end);
      store_lanes(out.q.group(i, group), sum[kRowQ], begin, end);
      store_lanes(out.v.group(i, group), sum[kRowV], begin, end);
      store_lanes(out.a.group(i, group), sum[kRowA], begin, end);
    }
  }
}

// Adds the terms between velocities of one node.
template <class T>
VP_NOINLINE void rotate_columns(DerivativesWork<T>& memory, const Node<base_t<T>>& node,
                                const UserDerivatives<T>* derivatives, const MatrixView<T>& tau_q) {
  const auto first = static_cast<std::size_t>(node.v), dofs = static_cast<std::size_t>(node.dofs);
  const dse3T<T> F = memory.velocity(node.v).wrench(kCompositeF);
  const auto S = [&](std::size_t k) {
    return memory.velocity(node.v + static_cast<int>(k)).twist(kColumnS);
  };
  for (std::size_t k = 0; k < dofs; ++k) {
    for (std::size_t i = 0; i < dofs; ++i) {
      T& tau = tau_q(first + k, first + i);
      if (k < i) tau += ad(S(i), S(k)) * F;
      if (derivatives != nullptr) tau += derivatives->S[dofs * k + i] * F;
    }
  }
}

// Adds to out, which must be zero, from the results of a call with the same q and v in the data's
// work. inverse: after inverse dynamics, with M; otherwise after forward dynamics, with L from its
// factors. Returns false if a user joint does not provide its derivatives.
template <class T>
bool differentiate(const State<T>& state, DerivativesWork<T>& memory, Span<dse3T<T>> external,
                   bool inverse, const InverseMatrices<T>& out) {
  if (!open(state, memory)) return false;
  take_loads(state, memory, external);
  const int velocities = static_cast<int>(memory.branches.size());
  for (int g = memory.groups(); g-- > 0;) {
    const int first = g * kSlots<T>, count = std::min(kSlots<T>, velocities - first);
    for (int k = count; k-- > 0;) add_to_parent(memory, first + k);
    close_group<T>(memory.group(g), memory.lanes());
    for (int k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(first + k);
      const auto forces = memory.lane(k);
      const dse3T<T> wrench = inverse ? forces.wrench(kForceA) : state.work.factors[i].W;
      const T W[6] = {wrench.m.x, wrench.m.y, wrench.m.z, wrench.f.x, wrench.f.y, wrench.f.z};
      fill_velocity(memory, first + k, forces, W, inverse, out);
      const auto& node = state.tree.nodes[static_cast<std::size_t>(memory.branches[i].node)];
      if (inverse) out.a(i, i) += T(node.armature);
      out.v(i, i) += T(node.damping);
    }
  }
  for (std::size_t i = 0; i < state.tree.nodes.size(); ++i) {
    const Node<base_t<T>>& node = state.tree.nodes[i];
    if (node.dofs == 1 && node.kind != NodeKind::user) continue;
    const int derivatives = memory.derivatives_of[i];
    rotate_columns(
        memory, node,
        derivatives < 0 ? nullptr : &memory.derivatives[static_cast<std::size_t>(derivatives)],
        out.q);
  }
  return true;
}

}  // namespace vp::detail::derivatives
