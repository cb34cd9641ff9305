// Forward dynamics: the articulated body algorithm, paper, appendix A, in the tree's frame.
//
//   base to tip   X, S, V, A, and each body's J_i and F_i (base_to_tip.h)
//   tip to base   U_i = J^_i S_i, Omega_i = <S_i, U_i> + armature
//                 J^_parent += J^_i - U_i (x) U_i / Omega_i
//                 u_i = tau_i - damping q'_i - <S_i, p^_i>,  p^_parent += p^_i + U_i u_i / Omega_i
//   base to tip   q''_i = (u_i - <U_i, a_parent>) / Omega_i,  a_i = a_parent + S_i q''_i
//
// A_i contains the effects of the velocities and of gravity, so the tip-to-base pass needs no J^ c.
// a_i is the part due to the joint accelerations. In one common frame the congruence of the paper's
// equation (6) is the identity.
#pragma once

#include "multibody/base_to_tip.h"
#include "multibody/child_sum.h"
#include "multibody/free_root.h"

namespace vp::detail {

// Whether each of many numbers exceeds its rounding bound; tested once at the end.
template <class T>
class AllPositive {
 public:
  void see(const T& x, const T& min_value) { fine_ = both(fine_, x > min_value); }
  bool fine() const { return all(fine_); }

 private:
  decltype(T(1) > T(0)) fine_ = T(1) > T(0);
};

// Factors one slot. Returns the articulated inertia for its parent.
template <class T>
AInertiaT<T> factor_out(const AInertiaT<T>& J, const se3T<T>& S, const Constants<T, T>& k,
                        Factor<T>& factor, AllPositive<T>& positive) {
  const dse3T<T> U = J * S;
  const T omega = S * U + k.get(kArmature);
  positive.see(omega, k.get(kMin));
  factor.inverse = T(1) / omega;
  factor.W = factor.inverse * U;
  const dse3T<T>& W = factor.W;
  const auto less = [](const Sym3T<T>& A, const Vec3T<T>& a, const Vec3T<T>& b) {
    return Sym3T<T>{A.xx - a.x * b.x, A.yy - a.y * b.y, A.zz - a.z * b.z,
                    A.xy - a.x * b.y, A.yz - a.y * b.z, A.zx - a.z * b.x};
  };
  const Mat3T<T>& H = J.coupling();
  return {less(J.angular(), U.m, W.m),
          {H.cx - W.f.x * U.m, H.cy - W.f.y * U.m, H.cz - W.f.z * U.m},
          less(J.linear(), U.f, W.f)};
}
// Computes the remaining part of the joint force x. Returns the force for its parent.
template <class T>
dse3T<T> force_out(const dse3T<T>& p, const se3T<T>& S, const T& x, Factor<T>& factor) {
  const T u = x - S * p;
  factor.x = u * factor.inverse;
  return p + u * factor.W;
}

// The same by rows.
template <class T>
void put_rows(const Work<T>& work, int g, int field, Row<T> (&numbers)[8]) {
  transpose_rows(numbers);
  for (int k = 0; k < kSlots<T>; ++k) store(work.row(g * kSlots<T> + k) + field, numbers[k]);
}
template <class T>
void put_inertia_rows(const Work<T>& work, int g, const Body<Row<T>>& body) {
  const Vec3T<Row<T>> h = body.mass * body.centre;
  const Sym3T<Row<T>> I = rotational(body, h);
  const Row<T> zero(0);
  Row<T> inertia[8] = {I.xx, I.yy, I.zz, I.xy, I.yz, I.zx, body.mass, zero};
  put_rows<T>(work, g, kRowInertia, inertia);
  Row<T> moment[8] = {h.x, h.y, h.z, -h.x, -h.y, -h.z, zero, zero};
  put_rows<T>(work, g, kRowMoment, moment);
}
template <class T, bool kForces>
bool factor_by_rows(const Tree<T>& tree, Work<T>& work, Span<T> v, Span<T> tau) {
  ChildSum<ArticulatedRows<T>> child_sum(work.row_flow);
  AllPositive<T> positive;
  for (int i = static_cast<int>(tree.slots.size()); i-- > 0;) {
    const Slot& slot = tree.slots[static_cast<std::size_t>(i)];
    const auto n = static_cast<std::size_t>(slot.v);
    const T* const row = work.row(i);
    const auto k = constants_of<T>(tree, i);
    Factor<T>& factor = work.factors[n];
    const se3T<T> S = work.slot(i).twist(kS);
    ArticulatedRows<T> load{columns_of<T>(vp::detail::load<Row<T>>(row + kRowInertia),
                                          vp::detail::load<Row<T>>(row + kRowMoment)),
                            vp::detail::load<Row<T>>(row + kRowForce)};
    load = load + child_sum.take(slot);
    alignas(64) T u[8], p[8];
    if (slot.kind == SlotKind::root) {
      const FreeRoot<T> root(tree, work, i);
      root.factor(triangle_of(load.J), positive);
      if constexpr (kForces) {
        store(p, load.p);
        root.take_forces(tau, v, wrench_from(p));
      }
      continue;
    }
    const Row<T> U = times(load.J, S);
    spread(u, U);
    const T omega = S * wrench_from(u) + k.get(kArmature);
    positive.see(omega, k.get(kMin));
    const T inverse = T(1) / omega;
    load.J = without(load.J, U, u, inverse);
    const Row<T> W = Row<T>(inverse) * U;
    store(&factor.W.m.x, W);
    T x(0);
    if constexpr (kForces) {
      spread(p, load.p);
      const T left = (tau[n] - k.get(kDamping) * v[n]) - S * wrench_from(p);
      x = left * inverse;
      load.p = load.p + Row<T>(left) * W;
    }
    factor.inverse = inverse;
    factor.x = x;
    child_sum.give(slot, load);
  }
  return positive.fine();
}

// Without forces, for the factors alone, the bodies' bias forces are not needed.
template <class T, bool kForces>
bool factor_by_slots(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> v, Span<T> tau) {
  ChildSum<Articulated<T>> child_sum(work.articulated_flow);
  AllPositive<T> positive;
  for (int i = static_cast<int>(tree.slots.size()); i-- > 0;) {
    const Slot& slot = tree.slots[static_cast<std::size_t>(i)];
    const auto n = static_cast<std::size_t>(slot.v);
    const auto fields = work.slot(i);
    const auto k = constants_of<T>(tree, i);
    Factor<T>& factor = work.factors[n];
    const InertiaT<T> body(k.get(kMass), fields.vec(kH), fields.sym(kI));
    const Articulated<T>& in = child_sum.take(slot);
    Articulated<T> load{body + in.J, fields.wrench(kF) + in.p};
    if (slot.kind == SlotKind::root) {
      const FreeRoot<T> root(tree, work, i);
      root.factor(triangle_of(load.J), positive);
      if constexpr (kForces) root.take_forces(tau, v, load.p);
      continue;
    }
    const se3T<T> S = fields.twist(kS);
    load.J = factor_out(load.J, S, k, factor, positive);
    if constexpr (kForces) {
      const T x = tau[n] - k.get(kDamping) * v[n];
      load.p = force_out(load.p, S, x, factor);
    }
    child_sum.give(slot, load);
  }
  return positive.fine();
}

template <class T, bool kForces>
bool factor(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> v, Span<T> tau) {
  if constexpr (kByRows<T>) return factor_by_rows<T, kForces>(tree, work, v, tau);
  return factor_by_slots<T, kForces>(tree, work, v, tau);
}

// x <- the joint accelerations, from the factors.
template <class T>
void expand(const Tree<base_t<T>>& tree, Work<T>& work, std::span<T> x) {
  se3T<T> a{};
  for (int i = 0; i < static_cast<int>(tree.slots.size()); ++i) {
    const Slot& slot = tree.slots[static_cast<std::size_t>(i)];
    const auto n = static_cast<std::size_t>(slot.v);
    if (slot.kind == SlotKind::root) {
      a = FreeRoot<T>(tree, work, i).expand(x);
    } else {
      if (!slot.to_previous) {
        a = slot.parent == kWorld ? se3T<T>{} : work.added[static_cast<std::size_t>(slot.parent)];
      }
      const Factor<T>& factor = work.factors[n];
      x[n] = factor.x - factor.W * a;
      a = a + x[n] * work.slot(i).twist(kS);
    }
    if (slot.forks) work.added[static_cast<std::size_t>(i)] = a;
  }
}

template <class T>
void set_inertia(const Work<T>& work, int g, const Body<Wide<T>>& body) {
  const auto fields = work.group(g);
  const Vec3T<Wide<T>> h = body.mass * body.centre;
  fields.set(kH, h);
  fields.set(kI, rotational(body, h));
}
// Stores a group's inertias and forces as the input of `factor`.
template <class T>
void put_body(const Work<T>& work, int g, const Body<Wide<T>>& body) {
  if constexpr (kByRows<T>) {
    put_inertia_rows<T>(work, g, body);
  } else {
    set_inertia(work, g, body);
  }
}
template <class T>
void put_force(const Work<T>& work, int g, const dse3T<Wide<T>>& F) {
  if constexpr (kByRows<T>) {
    Row<T> force[8] = {F.m.x, F.m.y, F.m.z, F.f.x, F.f.y, F.f.z, Row<T>(0), Row<T>(0)};
    put_rows<T>(work, g, kRowForce, force);
  } else {
    work.group(g).set(kF, F);
  }
}

template <class T>
VP_FLATTEN bool forward_dynamics_kernel(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q,
                                        Span<T> v, Span<T> tau, const Vec3T<T>& gravity,
                                        Span<dse3T<T>> external, std::span<T> a) {
  work.A_world.v = -gravity;
  pass_base_to_tip<T, PassDepth::accelerations>(
      tree, work, q, v, {}, BodyInTree<T>(),
      [&](int g, const auto& body, const auto& V, const auto& A) {
        put_body(work, g, body);
        put_force(work, g, body_force(body, V, A));
      });
  subtract_external<T, kByRows<T>>(tree, work, external);
  if (!factor<T, true>(tree, work, v, tau)) return false;
  expand<T>(tree, work, a);
  return true;
}

template <class T>
VP_FLATTEN bool factor_mass_kernel(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q) {
  pass_base_to_tip<T, PassDepth::poses>(
      tree, work, q, {}, {}, BodyInTree<T>(),
      [&](int g, const auto& body, const auto&, const auto&) { put_body(work, g, body); });
  return factor<T, false>(tree, work, {}, {});
}

template <class T>
VP_FLATTEN void solve_mass_kernel(const Tree<base_t<T>>& tree, Work<T>& work, std::span<T> x) {
  LightChildSum<Six<T>, PaddedSix<T>> child_sum(work.force_flow);
  for (int i = static_cast<int>(tree.slots.size()); i-- > 0;) {
    const Slot& slot = tree.slots[static_cast<std::size_t>(i)];
    const auto n = static_cast<std::size_t>(slot.v);
    const Six<T> in = child_sum.add(slot, {});
    const dse3T<T> p{in.head(), in.tail()};
    if (slot.kind == SlotKind::root) {
      FreeRoot<T>(tree, work, i).take_forces(x, {}, p);
      continue;
    }
    const dse3T<T> out = force_out(p, work.slot(i).twist(kS), x[n], work.factors[n]);
    child_sum.give(slot, Six<T>::of(out.m, out.f));
  }
  expand<T>(tree, work, x);
}

}  // namespace vp::detail
