// Forward dynamics: the articulated body algorithm, paper, appendix A, in the tree's frame.
//
//   outwards   X, S, V, A, and each body's J_i and F_i (outwards.h)
//   inwards    U_i = J^_i S_i, Omega_i = <S_i, U_i> + armature
//              J^_parent += J^_i - U_i (x) U_i / Omega_i
//              u_i = tau_i - damping q'_i - <S_i, p^_i>,  p^_parent += p^_i + U_i u_i / Omega_i
//   outwards   q''_i = (u_i - <U_i, a_parent>) / Omega_i,  a_i = a_parent + S_i q''_i
//
// A_i has all that the velocities and the field of gravity do, so the inward pass needs no J^ c;
// a_i is what the joints add. In one frame the congruence of the paper's equation (6) is the
// identity.
#pragma once

#include "multibody/free_root.h"
#include "multibody/inflow.h"
#include "multibody/outwards.h"

namespace vp::detail {

// Whether all of many numbers are positive, looked at once at the end.
template <class T>
class AllPositive {
 public:
  void see(const T& x) { fine_ = both(fine_, x > T(0)); }
  bool fine() const { return all(fine_); }

 private:
  decltype(T(1) > T(0)) fine_ = T(1) > T(0);
};

// One slot's factor, and the articulated inertia that it leaves to its parent.
template <class T>
AInertiaT<T> factor_out(const AInertiaT<T>& J, const se3T<T>& S, const T& armature,
                        Factor<T>& factor, AllPositive<T>& positive) {
  const dse3T<T> U = J * S;
  const T omega = S * U + armature;
  positive.see(omega);
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
// What is left of the joint's force x, and the force that it leaves to its parent.
template <class T>
dse3T<T> force_out(const dse3T<T>& p, const se3T<T>& S, const T& x, Factor<T>& factor) {
  const T u = x - S * p;
  factor.x = u * factor.inverse;
  return p + u * factor.W;
}

// The same by rows: of bodies and forces as put_rows has left them.
template <class T, bool kForces>
void put_rows(const Work<T>& work, int g, const Body<Row<T>>& body, const dse3T<Row<T>>& F) {
  const Vec3T<Row<T>> h = body.mass * body.centre;
  const Sym3T<Row<T>> I = rotational(body, h);
  const Row<T> zero(0);
  Row<T> inertia[8] = {I.xx, I.yy, I.zz, I.xy, I.yz, I.zx, body.mass, zero};
  Row<T> moment[8] = {h.x, h.y, h.z, -h.x, -h.y, -h.z, zero, zero};
  Row<T> force[8] = {F.m.x, F.m.y, F.m.z, F.f.x, F.f.y, F.f.z, zero, zero};
  transpose_rows(inertia);
  transpose_rows(moment);
  if constexpr (kForces) transpose_rows(force);
  for (int k = 0; k < kSlots<T>; ++k) {
    T* const row = work.row(g * kSlots<T> + k);
    store(row + kRowInertia, inertia[k]);
    store(row + kRowMoment, moment[k]);
    if constexpr (kForces) store(row + kRowForce, force[k]);
  }
}
template <class T>
dse3T<T> wrench_from(const T* at) {
  return {{at[0], at[1], at[2]}, {at[3], at[4], at[5]}};
}
template <class T, bool kForces>
bool factor_by_rows(const Tree<T>& tree, Work<T>& work, Span<T> v, Span<T> tau) {
  Inflow<ArticulatedRows<T>> inflow(work.row_flow);
  AllPositive<T> positive;
  for (int i = tree.velocities; i-- > 0;) {
    const auto n = static_cast<std::size_t>(i);
    const Slot& slot = tree.slots[n];
    const T* const row = work.row(i);
    const auto k = constants_of<T>(tree, i);
    Factor<T>& factor = work.factors[n];
    const se3T<T> S = work.slot(i).twist(kS);
    ArticulatedRows<T> load{columns_of<T>(vp::detail::load<Row<T>>(row + kRowInertia),
                                          vp::detail::load<Row<T>>(row + kRowMoment)),
                            vp::detail::load<Row<T>>(row + kRowForce)};
    load = load + inflow.take(slot);
    alignas(64) T u[8], p[8];
    if (slot.kind == SlotKind::root) {
      const FreeRoot<T> root(tree, work, i);
      root.factor(triangle_of(load.J), positive);
      if constexpr (kForces) {
        store(p, load.p);
        root.take_forces(tau, v, wrench_from(p));
      }
      i -= 5;
      continue;
    }
    const Row<T> U = times(load.J, S);
    spread(u, U);
    const T omega = S * wrench_from(u) + k.get(kArmature);
    positive.see(omega);
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
    inflow.give(slot, load);
  }
  return positive.fine();
}

// Without the velocities' part, for factors alone, bodies' forces are not needed.
template <class T, bool kForces>
bool factor_by_slots(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> v, Span<T> tau) {
  Inflow<Articulated<T>> inflow(work.articulated_flow);
  AllPositive<T> positive;
  for (int i = tree.velocities; i-- > 0;) {
    const Slot& slot = tree.slots[static_cast<std::size_t>(i)];
    const auto fields = work.slot(i);
    const auto k = constants_of<T>(tree, i);
    Factor<T>& factor = work.factors[static_cast<std::size_t>(i)];
    const InertiaT<T> body(k.get(kMass), fields.vec(kH), fields.sym(kI));
    const Articulated<T>& in = inflow.take(slot);
    Articulated<T> load{body + in.J, fields.wrench(kF) + in.p};
    if (slot.kind == SlotKind::root) {
      const FreeRoot<T> root(tree, work, i);
      root.factor(triangle_of(load.J), positive);
      if constexpr (kForces) root.take_forces(tau, v, load.p);
      i -= 5;
      continue;
    }
    const se3T<T> S = fields.twist(kS);
    load.J = factor_out(load.J, S, k.get(kArmature), factor, positive);
    if constexpr (kForces) {
      const auto n = static_cast<std::size_t>(i);
      const T x = tau[n] - k.get(kDamping) * v[n];
      load.p = force_out(load.p, S, x, factor);
    }
    inflow.give(slot, load);
  }
  return positive.fine();
}

template <class T, bool kForces>
bool factor(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> v, Span<T> tau) {
  if constexpr (kByRows<T>) return factor_by_rows<T, kForces>(tree, work, v, tau);
  return factor_by_slots<T, kForces>(tree, work, v, tau);
}

// x <- the joints' accelerations that the factors have left.
template <class T>
void expand(const Tree<base_t<T>>& tree, Work<T>& work, std::span<T> x) {
  se3T<T> a{};
  for (int i = 0; i < tree.velocities; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Slot& slot = tree.slots[n];
    if (slot.kind == SlotKind::root) {
      a = FreeRoot<T>(tree, work, i + 5).expand(x);
      i += 5;
      work.added[n + 5] = a;
      continue;
    }
    if (!slot.to_previous) {
      a = slot.parent == kWorld ? se3T<T>{} : work.added[static_cast<std::size_t>(slot.parent)];
    }
    const Factor<T>& factor = work.factors[n];
    x[n] = factor.x - factor.W * a;
    a = a + x[n] * work.slot(i).twist(kS);
    if (slot.forks) work.added[n] = a;
  }
}

template <class T>
void set_inertia(const Work<T>& work, int g, const Body<Wide<T>>& body) {
  const auto fields = work.group(g);
  const Vec3T<Wide<T>> h = body.mass * body.centre;
  fields.set(kH, h);
  fields.set(kI, rotational(body, h));
}

template <class T>
VP_FLATTEN bool forward_dynamics_kernel(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q,
                                        Span<T> v, Span<T> tau, const Vec3T<T>& gravity,
                                        Span<dse3T<T>> external, std::span<T> a) {
  work.set_world(-gravity);
  outwards<T, Reach::accelerations>(tree, work, q, v, {}, [&](int g, const auto& k) {
    const auto fields = work.group(g);
    const auto body = body_in_tree(k, fields.pose(kX));
    const auto F = body_force(body, fields.twist(kV), fields.twist(kA));
    if constexpr (kByRows<T>) {
      put_rows<T, true>(work, g, body, F);
    } else {
      set_inertia(work, g, body);
      fields.set(kF, F);
    }
  });
  subtract_external<T, kByRows<T>>(tree, work, external);
  if (!factor<T, true>(tree, work, v, tau)) return false;
  expand<T>(tree, work, a);
  return true;
}

template <class T>
VP_FLATTEN bool factor_mass_kernel(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q) {
  outwards<T, Reach::poses>(tree, work, q, {}, {}, [&](int g, const auto& k) {
    const auto body = body_in_tree(k, work.group(g).pose(kX));
    if constexpr (kByRows<T>) {
      put_rows<T, false>(work, g, body, {});
    } else {
      set_inertia(work, g, body);
    }
  });
  return factor<T, false>(tree, work, {}, {});
}

template <class T>
VP_FLATTEN void solve_mass_kernel(const Tree<base_t<T>>& tree, Work<T>& work, std::span<T> x) {
  LightInflow<dse3T<T>> inflow(work.force_flow);
  for (int i = tree.velocities; i-- > 0;) {
    const auto n = static_cast<std::size_t>(i);
    const Slot& slot = tree.slots[n];
    const dse3T<T> p = inflow.add(slot, {});
    if (slot.kind == SlotKind::root) {
      FreeRoot<T>(tree, work, i).take_forces(x, {}, p);
      i -= 5;
      continue;
    }
    inflow.give(slot, force_out(p, work.slot(i).twist(kS), x[n], work.factors[n]));
  }
  expand<T>(tree, work, x);
}

}  // namespace vp::detail
