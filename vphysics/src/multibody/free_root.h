// A free root: six velocities in one slot.
//
// Its velocities are those of the link in its own axes. The factors are in the axes of the tree,
// where the motion subspace is the identity: the articulated inertia itself is factored as L D L^T,
// last velocity first. The rotation leaves damping and armature unchanged, because the joint has
// one value of each. There is no bias acceleration, because the origin moves with the root.
#pragma once

#include <limits>

#include "multibody/joints.h"

namespace vp::detail {

// The lower triangle of J by rows: (i, j) with j <= i.
template <class T>
struct Triangle {
  T m[6][6];
};
template <class T>
Triangle<T> triangle_of(const AInertiaT<T>& J) {
  const Sym3T<T>&A = J.angular(), &C = J.linear();
  const Mat3T<T>& H = J.coupling();
  return {{{A.xx},
           {A.xy, A.yy},
           {A.zx, A.yz, A.zz},
           {H.cx.x, H.cx.y, H.cx.z, C.xx},
           {H.cy.x, H.cy.y, H.cy.z, C.xy, C.yy},
           {H.cz.x, H.cz.y, H.cz.z, C.zx, C.yz, C.zz}}};
}
template <class T>
Triangle<T> triangle_of(const ColumnInertia<T>& J) {
  Triangle<T> out;
  for (int k = 0; k < 6; ++k) {
    alignas(64) T column[8];
    store(column, J.c[k]);
    for (int i = 0; i <= k; ++i) out.m[k][i] = column[i];
  }
  return out;
}

template <class T>
class FreeRoot {
 public:
  FreeRoot(const Tree<base_t<T>>& tree, Work<T>& work, int slot)
      : work_(work),
        first_(tree.slots[static_cast<std::size_t>(slot)].v),
        k_(constants_of<T>(tree, slot)),
        R_(work.slot(slot).mat(kX)) {}

  // Factors J. Reports a pivot that is not positive to `positive`.
  template <class Positive>
  void factor(Triangle<T> J, Positive& positive) const {
    const T armature = k_.get(kArmature), turns = k_.get(kMin);
    const T slides = T(16) * T(std::numeric_limits<base_t<T>>::epsilon()) * k_.get(kSubtreeMass);
    for (int k = 6; k-- > 0;) {
      const T omega = J.m[k][k] + armature;
      positive.see(omega, k < 3 ? turns : slides);
      const T inverse = T(1) / omega;
      T w[6] = {};
      for (int i = 0; i < k; ++i) w[i] = inverse * J.m[k][i];
      for (int i = 0; i < k; ++i) {
        for (int j = 0; j <= i; ++j) J.m[i][j] = J.m[i][j] - J.m[k][i] * w[j];
      }
      w[k] = T(1);
      Factor<T>& f = at(k);
      f.inverse = inverse;
      f.W = {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}};
    }
  }
  // Computes the forces in the factors, from the joint forces tau, minus damping, and the bias
  // force.
  void take_forces(Span<T> tau, Span<T> v, const dse3T<T>& bias) const {
    Six<T> u = numbers(tau);
    if (!v.empty()) {
      const Six<T> rate = numbers(v);
      const T damping = k_.get(kDamping);
      for (int k = 0; k < 6; ++k) u.x[k] = u.x[k] - damping * rate.x[k];
    }
    Six<T> p = Six<T>::of(bias.m, bias.f);
    const Six<T> turned = Six<T>::of(out_of_link(u.head()), out_of_link(u.tail()));
    for (int k = 6; k-- > 0;) {
      Factor<T>& f = at(k);
      const T left = turned.x[k] - p.x[k];
      f.x = left * f.inverse;
      const Six<T> w = Six<T>::of(f.W.m, f.W.f);
      for (int i = 0; i < k; ++i) p.x[i] = p.x[i] + left * w.x[i];
    }
  }
  // Base to tip: returns the acceleration, and writes it in the link's axes to x.
  se3T<T> expand(std::span<T> x) const {
    Six<T> a;
    for (int k = 0; k < 6; ++k) {
      const Factor<T>& f = at(k);
      const Six<T> w = Six<T>::of(f.W.m, f.W.f);
      a.x[k] = f.x;
      for (int i = 0; i < k; ++i) a.x[k] = a.x[k] - w.x[i] * a.x[i];
    }
    const Six<T> own = Six<T>::of(transposed_times(R_, a.head()), transposed_times(R_, a.tail()));
    for (int k = 0; k < 6; ++k) x[static_cast<std::size_t>(first_ + k)] = own.x[k];
    return {a.head(), a.tail()};
  }

 private:
  Six<T> numbers(Span<T> from) const {
    Six<T> out;
    for (int k = 0; k < 6; ++k) out.x[k] = from[static_cast<std::size_t>(first_ + k)];
    return out;
  }
  // R^-T a, with one refinement step.
  Vec3T<T> out_of_link(const Vec3T<T>& a) const {
    const Vec3T<T> b = R_ * a;
    return b + R_ * (a - transposed_times(R_, b));
  }
  Factor<T>& at(int k) const { return work_.factors[static_cast<std::size_t>(first_ + k)]; }

  Work<T>& work_;
  int first_;
  Constants<T, T> k_;
  Mat3T<T> R_;
};

}  // namespace vp::detail
