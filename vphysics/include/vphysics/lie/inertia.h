// The generalized inertia of a rigid body: paper, section 4.3 and appendix B.
//
// Ten scalars in one frame: mass m, first moment h = m c (c: centre of mass) and the rotational
// inertia I about the frame's origin. J V = (I w + h x v, m v - h x w).
#pragma once

#include "vphysics/lie/se3.h"

namespace vp {

// Symmetric 3x3.
template <class T>
struct Sym3T {
  T xx{}, yy{}, zz{}, xy{}, yz{}, zx{};
  constexpr bool operator==(const Sym3T&) const = default;
};

template <class T>
constexpr Sym3T<T> operator+(const Sym3T<T>& a, const Sym3T<T>& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
}
template <class T>
constexpr Sym3T<T> operator-(const Sym3T<T>& a, const Sym3T<T>& b) {
  return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.zx - b.zx};
}
template <class T>
constexpr Sym3T<T> operator*(T s, const Sym3T<T>& a) {
  return {s * a.xx, s * a.yy, s * a.zz, s * a.xy, s * a.yz, s * a.zx};
}
template <class T>
constexpr Vec3T<T> operator*(const Sym3T<T>& A, const Vec3T<T>& b) {
  return {A.xx * b.x + A.xy * b.y + A.zx * b.z, A.xy * b.x + A.yy * b.y + A.yz * b.z,
          A.zx * b.x + A.yz * b.y + A.zz * b.z};
}
// s a a^T
template <class T>
constexpr Sym3T<T> outer(T s, const Vec3T<T>& a) {
  return {s * a.x * a.x, s * a.y * a.y, s * a.z * a.z, s * a.x * a.y, s * a.y * a.z, s * a.z * a.x};
}
// R A R^T
template <class T>
constexpr Sym3T<T> rotated(const Mat3T<T>& R, const Sym3T<T>& A) {
  const Mat3T<T> B = R * Mat3T<T>{{A.xx, A.xy, A.zx}, {A.xy, A.yy, A.yz}, {A.zx, A.yz, A.zz}};
  const Mat3T<T> Rt = transpose(R);
  const Vec3T<T> cx = B * Rt.cx, cy = B * Rt.cy, cz = B * Rt.cz;
  return {cx.x, cy.y, cz.z, cy.x, cz.y, cz.x};
}
// Inverse; precondition: not singular.
template <class T>
constexpr Sym3T<T> inverse(const Sym3T<T>& A) {
  const T cxx = A.yy * A.zz - A.yz * A.yz;
  const T cxy = A.zx * A.yz - A.xy * A.zz;
  const T czx = A.xy * A.yz - A.zx * A.yy;
  const T s = T(1) / (A.xx * cxx + A.xy * cxy + A.zx * czx);
  return {s * cxx, s * (A.xx * A.zz - A.zx * A.zx), s * (A.xx * A.yy - A.xy * A.xy),
          s * cxy, s * (A.xy * A.zx - A.xx * A.yz), s * czx};
}

template <class T>
class InertiaT {
 public:
  constexpr InertiaT() = default;
  // About the frame's origin: mass, first moment m c, rotational inertia.
  constexpr InertiaT(T mass, const Vec3T<T>& first_moment, const Sym3T<T>& rotational)
      : mass_(mass), h_(first_moment), I_(rotational) {}
  // Centre of mass at the origin, principal axes along the frame's.
  constexpr InertiaT(T mass, const Vec3T<T>& principal)
      : mass_(mass), I_{principal.x, principal.y, principal.z, 0, 0, 0} {}

  constexpr T mass() const { return mass_; }
  constexpr const Vec3T<T>& first_moment() const { return h_; }
  constexpr const Sym3T<T>& rotational() const { return I_; }
  // Precondition: mass > 0.
  constexpr Vec3T<T> centre_of_mass() const { return (T(1) / mass_) * h_; }
  // Rotational inertia about the centre of mass; precondition: mass > 0.
  constexpr Sym3T<T> central() const { return I_ - point_inertia(mass_, centre_of_mass()); }

  // The same inertia seen from another frame: with T_b_a, from frame b to frame a. As a bilinear
  // form, J' = dAd_T J Ad_T; eq. (6) has (...).Xform(Inv(f)).
  constexpr InertiaT Xform(const SE3T<T>& A) const {
    // Rotate into the axes of a, then move the origin by r = position of a in the axes of a.
    const Mat3T<T> Rt = transpose(A.rotation());
    const Vec3T<T> r = A.unrotate(A.position());
    const Vec3T<T> h = Rt * h_;
    const Vec3T<T> moved = h - mass_ * r;
    // I - m [r][r] + [h][r] + [r][h], written with h and r: I' = I + m P(r) - 2 sym terms.
    const T hr = dot(h, r);
    const Sym3T<T> cross_terms = {T(2) * (hr - h.x * r.x),  T(2) * (hr - h.y * r.y),
                                  T(2) * (hr - h.z * r.z),  -(h.x * r.y + h.y * r.x),
                                  -(h.y * r.z + h.z * r.y), -(h.z * r.x + h.x * r.z)};
    return {mass_, moved, rotated(Rt, I_) + point_inertia(mass_, r) - cross_terms};
  }

  constexpr bool operator==(const InertiaT&) const = default;

 private:
  // m (|c|^2 - c c^T): rotational inertia of a point mass at c.
  static constexpr Sym3T<T> point_inertia(T m, const Vec3T<T>& c) {
    const T cc = m * dot(c, c);
    return Sym3T<T>{cc, cc, cc, 0, 0, 0} - outer(m, c);
  }

  T mass_{};
  Vec3T<T> h_;
  Sym3T<T> I_;
};

template <class T>
constexpr dse3T<T> operator*(const InertiaT<T>& J, const se3T<T>& V) {
  return {J.rotational() * V.w + cross(J.first_moment(), V.v),
          J.mass() * V.v - cross(J.first_moment(), V.w)};
}
// Inertias of parts rigidly joined, in the same frame.
template <class T>
constexpr InertiaT<T> operator+(const InertiaT<T>& a, const InertiaT<T>& b) {
  return {a.mass() + b.mass(), a.first_moment() + b.first_moment(),
          a.rotational() + b.rotational()};
}

using Sym3 = Sym3T<double>;
using Inertia = InertiaT<double>;

static_assert(sizeof(Inertia) == 10 * sizeof(double));

}  // namespace vp
