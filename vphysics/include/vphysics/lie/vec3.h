// Vectors of R^3 and 3x3 matrices.
#pragma once

#include <cmath>

namespace vp {

template <class T>
struct Vec3T {
  T x{}, y{}, z{};

  constexpr Vec3T& operator+=(const Vec3T& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3T& operator-=(const Vec3T& b) { return *this = {x - b.x, y - b.y, z - b.z}; }
  constexpr Vec3T& operator*=(T s) { return *this = {x * s, y * s, z * s}; }
  constexpr bool operator==(const Vec3T&) const = default;

  constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
};

template <class T>
constexpr Vec3T<T> operator+(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
constexpr Vec3T<T> operator-(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
constexpr Vec3T<T> operator-(const Vec3T<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
constexpr Vec3T<T> operator*(T s, const Vec3T<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
constexpr Vec3T<T> operator*(const Vec3T<T>& a, T s) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
constexpr T dot(const Vec3T<T>& a, const Vec3T<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3T<T> cross(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T norm(const Vec3T<T>& a) {
  return std::sqrt(dot(a, a));
}
template <class T>
bool is_finite(const Vec3T<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

// Stored by columns: for a rotation, the images of the three axes.
template <class T>
struct Mat3T {
  Vec3T<T> cx, cy, cz;

  static constexpr Mat3T identity() { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }
  constexpr T operator()(int row, int column) const {
    return column == 0 ? cx[row] : column == 1 ? cy[row] : cz[row];
  }
  constexpr bool operator==(const Mat3T&) const = default;
};

template <class T>
constexpr Vec3T<T> operator*(const Mat3T<T>& A, const Vec3T<T>& b) {
  return A.cx * b.x + A.cy * b.y + A.cz * b.z;
}
template <class T>
constexpr Mat3T<T> operator*(const Mat3T<T>& A, const Mat3T<T>& B) {
  return {A * B.cx, A * B.cy, A * B.cz};
}
// A^T b, without building A^T.
template <class T>
constexpr Vec3T<T> transposed_times(const Mat3T<T>& A, const Vec3T<T>& b) {
  return {dot(A.cx, b), dot(A.cy, b), dot(A.cz, b)};
}
template <class T>
constexpr Mat3T<T> transpose(const Mat3T<T>& A) {
  return {{A.cx.x, A.cy.x, A.cz.x}, {A.cx.y, A.cy.y, A.cz.y}, {A.cx.z, A.cy.z, A.cz.z}};
}

// Unit quaternion (x, y, z, w) of a rotation, for the wire; w >= 0.
template <class T>
struct QuaternionT {
  T x{}, y{}, z{}, w{1};
};

// Shepperd's method: the largest of the four components is found first, so that nothing is divided
// by a small number and the result is exact near every half turn.
template <class T>
QuaternionT<T> to_quaternion(const Mat3T<T>& R) {
  const T xx = R.cx.x, yy = R.cy.y, zz = R.cz.z;
  const T trace = xx + yy + zz;
  QuaternionT<T> q;
  if (trace >= xx && trace >= yy && trace >= zz) {
    q = {R.cy.z - R.cz.y, R.cz.x - R.cx.z, R.cx.y - R.cy.x, T(1) + trace};
  } else if (xx >= yy && xx >= zz) {
    q = {T(1) + xx - yy - zz, R.cx.y + R.cy.x, R.cz.x + R.cx.z, R.cy.z - R.cz.y};
  } else if (yy >= zz) {
    q = {R.cx.y + R.cy.x, T(1) + yy - zz - xx, R.cy.z + R.cz.y, R.cz.x - R.cx.z};
  } else {
    q = {R.cz.x + R.cx.z, R.cy.z + R.cz.y, T(1) + zz - xx - yy, R.cx.y - R.cy.x};
  }
  const T n = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  const T s = (q.w < T(0) ? T(-1) : T(1)) / n;
  return {q.x * s, q.y * s, q.z * s, q.w * s};
}

// Any quaternion but zero: it is normalised.
template <class T>
Mat3T<T> from_quaternion(const QuaternionT<T>& q) {
  const T s = T(2) / (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  const T xx = s * q.x * q.x, yy = s * q.y * q.y, zz = s * q.z * q.z;
  const T xy = s * q.x * q.y, yz = s * q.y * q.z, zx = s * q.z * q.x;
  const T wx = s * q.w * q.x, wy = s * q.w * q.y, wz = s * q.w * q.z;
  return {{T(1) - yy - zz, xy + wz, zx - wy},
          {xy - wz, T(1) - zz - xx, yz + wx},
          {zx + wy, yz - wx, T(1) - xx - yy}};
}

using Vec3 = Vec3T<double>;
using Mat3 = Mat3T<double>;
using Quaternion = QuaternionT<double>;

}  // namespace vp
