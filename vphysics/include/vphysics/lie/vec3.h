// Vectors of R^3 and 3x3 matrices.
#pragma once

#include <cmath>
#include <type_traits>

namespace vp {

template <class T>
struct Vec3T {
  T x{}, y{}, z{};

  constexpr Vec3T& operator+=(const Vec3T& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3T& operator-=(const Vec3T& b) { return *this = {x - b.x, y - b.y, z - b.z}; }
  constexpr Vec3T& operator*=(T s) { return *this = {x * s, y * s, z * s}; }
  bool operator==(const Vec3T&) const = default;

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
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <class T>
bool is_finite(const Vec3T<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

// Stored by columns. The columns of a rotation are the images of the three axes.
template <class T>
struct Mat3T {
  Vec3T<T> cx, cy, cz;

  static constexpr Mat3T identity() { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }
  constexpr T operator()(int row, int column) const {
    return column == 0 ? cx[row] : column == 1 ? cy[row] : cz[row];
  }
  bool operator==(const Mat3T&) const = default;
};

template <class T>
constexpr Vec3T<T> operator*(const Mat3T<T>& A, const Vec3T<T>& b) {
  return A.cx * b.x + A.cy * b.y + A.cz * b.z;
}
template <class T>
constexpr Mat3T<T> operator*(const Mat3T<T>& A, const Mat3T<T>& B) {
  return {A * B.cx, A * B.cy, A * B.cz};
}
// A^T b, without computing A^T.
template <class T>
constexpr Vec3T<T> transposed_times(const Mat3T<T>& A, const Vec3T<T>& b) {
  return {dot(A.cx, b), dot(A.cy, b), dot(A.cz, b)};
}
template <class T>
constexpr Mat3T<T> transpose(const Mat3T<T>& A) {
  return {{A.cx.x, A.cy.x, A.cz.x}, {A.cx.y, A.cy.y, A.cz.y}, {A.cx.z, A.cy.z, A.cz.z}};
}

// [a], with [a] b = a x b.
template <class T>
constexpr Mat3T<T> skew(const Vec3T<T>& a) {
  return {{T(0), a.z, -a.y}, {-a.z, T(0), a.x}, {a.y, -a.x, T(0)}};
}
template <class T>
constexpr Mat3T<T> operator+(const Mat3T<T>& A, const Mat3T<T>& B) {
  return {A.cx + B.cx, A.cy + B.cy, A.cz + B.cz};
}
template <class T>
constexpr Mat3T<T> operator-(const Mat3T<T>& A, const Mat3T<T>& B) {
  return {A.cx - B.cx, A.cy - B.cy, A.cz - B.cz};
}
template <class T>
constexpr Mat3T<T> operator*(const std::type_identity_t<T>& s, const Mat3T<T>& A) {
  return {s * A.cx, s * A.cy, s * A.cz};
}
// A^T B, without computing A^T.
template <class T>
constexpr Mat3T<T> transposed_times(const Mat3T<T>& A, const Mat3T<T>& B) {
  return {transposed_times(A, B.cx), transposed_times(A, B.cy), transposed_times(A, B.cz)};
}

using Vec3 = Vec3T<double>;
using Mat3 = Mat3T<double>;

}  // namespace vp
