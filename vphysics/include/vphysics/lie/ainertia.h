// The articulated inertia of a body and its descendants: paper, sections 4.3, 4.4, appendix B.
//
// A symmetric 6x6 matrix in blocks, 21 scalars: J V = (I w + H v, H^T w + M v). A rigid body has H
// = [h] and M = m 1; InertiaT converts to it.
//
// Equation (6), the step of the recursion, reads as in the paper's Table 2:
//   eta = J[i] * S[i];
//   J[i-1] = I[i-1] + (J[i] - (eta*eta) / (S[i]*eta)).Xform(Inv(f[i]));
#pragma once

#include "vphysics/lie/inertia.h"

namespace vp {

template <class T>
class AInertiaT {
 public:
  constexpr AInertiaT() = default;
  constexpr AInertiaT(const Sym3T<T>& I, const Mat3T<T>& H, const Sym3T<T>& M)
      : I_(I), H_(H), M_(M) {}
  constexpr AInertiaT(const InertiaT<T>& J)
      : I_(J.rotational()), H_(skew(J.first_moment())), M_{J.mass(), J.mass(), J.mass(),
                                                           T(0),     T(0),     T(0)} {}

  constexpr const Sym3T<T>& angular() const { return I_; }
  constexpr const Mat3T<T>& coupling() const { return H_; }
  constexpr const Sym3T<T>& linear() const { return M_; }

  // The same inertia in another frame: with T_b_a, from frame b to frame a. As a bilinear form, J'
  // = dAd_T J Ad_T.
  constexpr AInertiaT Xform(const SE3T<T>& A) const {
    // Moves the origin by p first: G = H - [p] M and I' = I + (H [p])^T + G [p], whose sum is
    // symmetric. Then rotates the axes.
    const Vec3T<T>& p = A.position();
    const Mat3T<T> G = {H_.cx - cross(p, Vec3T<T>{M_.xx, M_.xy, M_.zx}),
                        H_.cy - cross(p, Vec3T<T>{M_.xy, M_.yy, M_.yz}),
                        H_.cz - cross(p, Vec3T<T>{M_.zx, M_.yz, M_.zz})};
    // Row i of X [p] is (row i of X) x p.
    const Sym3T<T> I = {I_.xx + (G.cy.x + H_.cy.x) * p.z - (G.cz.x + H_.cz.x) * p.y,
                        I_.yy + (G.cz.y + H_.cz.y) * p.x - (G.cx.y + H_.cx.y) * p.z,
                        I_.zz + (G.cx.z + H_.cx.z) * p.y - (G.cy.z + H_.cy.z) * p.x,
                        I_.xy + (G.cz.x * p.x - G.cx.x * p.z) + (H_.cy.y * p.z - H_.cz.y * p.y),
                        I_.yz + (G.cx.y * p.y - G.cy.y * p.x) + (H_.cz.z * p.x - H_.cx.z * p.z),
                        I_.zx + (G.cy.z * p.z - G.cz.z * p.y) + (H_.cx.x * p.y - H_.cy.x * p.x)};
    const Mat3T<T>& R = A.rotation();
    return {unrotated(R, I), transposed_times(R, G * R), unrotated(R, M_)};
  }

  bool operator==(const AInertiaT&) const = default;

 private:
  Sym3T<T> I_;
  Mat3T<T> H_{};
  Sym3T<T> M_;
};

template <class T>
constexpr AInertiaT<T> operator+(const AInertiaT<T>& a, const AInertiaT<T>& b) {
  return {a.angular() + b.angular(), a.coupling() + b.coupling(), a.linear() + b.linear()};
}
template <class T>
constexpr AInertiaT<T> operator-(const AInertiaT<T>& a, const AInertiaT<T>& b) {
  return {a.angular() - b.angular(), a.coupling() - b.coupling(), a.linear() - b.linear()};
}
// Uses only the 10 scalars of the rigid body.
template <class T>
constexpr AInertiaT<T> operator+(const InertiaT<T>& a, const AInertiaT<T>& b) {
  const Vec3T<T>& h = a.first_moment();
  const Mat3T<T>& H = b.coupling();
  const Sym3T<T>& M = b.linear();
  return {a.rotational() + b.angular(),
          {{H.cx.x, H.cx.y + h.z, H.cx.z - h.y},
           {H.cy.x - h.z, H.cy.y, H.cy.z + h.x},
           {H.cz.x + h.y, H.cz.y - h.x, H.cz.z}},
          {a.mass() + M.xx, a.mass() + M.yy, a.mass() + M.zz, M.xy, M.yz, M.zx}};
}
template <class T>
constexpr AInertiaT<T> operator+(const AInertiaT<T>& a, const InertiaT<T>& b) {
  return b + a;
}
template <class T>
constexpr AInertiaT<T> operator*(const std::type_identity_t<T>& s, const AInertiaT<T>& a) {
  return {s * a.angular(), s * a.coupling(), s * a.linear()};
}
template <class T>
constexpr AInertiaT<T> operator/(const AInertiaT<T>& a, const std::type_identity_t<T>& s) {
  return (T(1) / s) * a;
}
template <class T>
constexpr dse3T<T> operator*(const AInertiaT<T>& J, const se3T<T>& V) {
  return {J.angular() * V.w + J.coupling() * V.v,
          transposed_times(J.coupling(), V.w) + J.linear() * V.v};
}

// The paper's symmetric product of two wrenches: (a b^T + b a^T) / 2.
template <class T>
constexpr AInertiaT<T> operator*(const dse3T<T>& a, const dse3T<T>& b) {
  const Vec3T<T> m = T(0.5) * a.m, f = T(0.5) * a.f;
  const auto symmetric = [](const Vec3T<T>& x, const Vec3T<T>& half, const Vec3T<T>& y) {
    return Sym3T<T>{x.x * y.x,
                    x.y * y.y,
                    x.z * y.z,
                    half.x * y.y + half.y * y.x,
                    half.y * y.z + half.z * y.y,
                    half.z * y.x + half.x * y.z};
  };
  return {symmetric(a.m, m, b.m),
          {b.f.x * m + f.x * b.m, b.f.y * m + f.y * b.m, b.f.z * m + f.z * b.m},
          symmetric(a.f, f, b.f)};
}
// s a a^T
template <class T>
constexpr AInertiaT<T> outer(const std::type_identity_t<T>& s, const dse3T<T>& a) {
  const Vec3T<T> m = s * a.m, f = s * a.f;
  const auto symmetric = [](const Vec3T<T>& x, const Vec3T<T>& y) {
    return Sym3T<T>{x.x * y.x, x.y * y.y, x.z * y.z, x.x * y.y, x.y * y.z, x.z * y.x};
  };
  return {symmetric(m, a.m), {a.f.x * m, a.f.y * m, a.f.z * m}, symmetric(f, a.f)};
}

using AInertia = AInertiaT<double>;

static_assert(sizeof(AInertia) == 21 * sizeof(double));

}  // namespace vp
