// The generalized inertia of a rigid body: paper, section 4.3 and appendix B.
//
// Ten scalars in one frame: mass m, first moment h = m c (c: centre of mass) and rotational inertia
// I about the frame's origin. J V = (I w + h x v, m v - h x w).
#pragma once

#include "vphysics/lie/se3.h"

namespace vp {

// Symmetric 3x3.
template <class T>
struct Sym3T {
  T xx{}, yy{}, zz{}, xy{}, yz{}, zx{};
  bool operator==(const Sym3T&) const = default;
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
// R^T A R and R A R^T
template <class T>
constexpr Sym3T<T> unrotated(const Mat3T<T>& R, const Sym3T<T>& A) {
  const Vec3T<T> x = A * R.cx, y = A * R.cy, z = A * R.cz;
  return {dot(R.cx, x), dot(R.cy, y), dot(R.cz, z), dot(R.cx, y), dot(R.cy, z), dot(R.cz, x)};
}
template <class T>
constexpr Sym3T<T> rotated(const Mat3T<T>& R, const Sym3T<T>& A) {
  return unrotated(transpose(R), A);
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
  // Centre of mass at the origin, principal axes along the frame's axes.
  constexpr InertiaT(T mass, const Vec3T<T>& principal)
      : mass_(mass), I_{principal.x, principal.y, principal.z, 0, 0, 0} {}

  constexpr T mass() const { return mass_; }
  constexpr const Vec3T<T>& first_moment() const { return h_; }
  constexpr const Sym3T<T>& rotational() const { return I_; }
  // Precondition: mass > 0.
  constexpr Vec3T<T> centre_of_mass() const { return (T(1) / mass_) * h_; }
  // Rotational inertia about the centre of mass; precondition: mass > 0.
  constexpr Sym3T<T> central() const { return I_ - point_inertia(mass_, centre_of_mass()); }

  // The same inertia in another frame: with T_b_a, from frame b to frame a. As a bilinear form, J'
  // = dAd_T J Ad_T; eq. (6) has (...).Xform(Inv(f)).
  constexpr InertiaT Xform(const SE3T<T>& A) const {
    const InertiaT moved = about(A.position());
    return {mass_, A.unrotate(moved.h_), unrotated(A.rotation(), moved.I_)};
  }
  // Xform(Inv(A)), without building the inverse: with T_a_b, from frame b to frame a.
  constexpr InertiaT InvXform(const SE3T<T>& A) const {
    return InertiaT(mass_, A.rotate(h_), rotated(A.rotation(), I_)).about(-A.position());
  }
  // The same axes, with the origin at the point p. With h' = h - m p and g = h + h',
  //   I' = I + (p g^T + g p^T) / 2 - (g . p) 1.
  constexpr InertiaT about(const Vec3T<T>& p) const {
    const Vec3T<T> moved = h_ - mass_ * p;
    const Vec3T<T> g = h_ + moved, k = T(0.5) * g;
    const T xx = g.x * p.x, yy = g.y * p.y, zz = g.z * p.z;
    return {
        mass_,
        moved,
        {I_.xx - (yy + zz), I_.yy - (zz + xx), I_.zz - (xx + yy), I_.xy + (k.x * p.y + k.y * p.x),
         I_.yz + (k.y * p.z + k.z * p.y), I_.zx + (k.z * p.x + k.x * p.z)}};
  }

  bool operator==(const InertiaT&) const = default;

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
// The inertia of rigidly connected parts, in the same frame.
template <class T>
constexpr InertiaT<T> operator+(const InertiaT<T>& a, const InertiaT<T>& b) {
  return {a.mass() + b.mass(), a.first_moment() + b.first_moment(),
          a.rotational() + b.rotational()};
}

using Sym3 = Sym3T<double>;
using Inertia = InertiaT<double>;

static_assert(sizeof(Inertia) == 10 * sizeof(double));

}  // namespace vp
