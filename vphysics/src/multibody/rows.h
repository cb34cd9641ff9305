// One state in registers of eight numbers: the recursions by rows.
//
// Between slots nothing is alike, so the recursions of one state cannot use a lane for each slot as
// the rest of a pass does (lanes.h). With registers of 512 bits they use lanes for the numbers of
// one slot instead: a pose is four columns of four, a force one register, an articulated inertia
// six.
#pragma once

#include "multibody/lanes.h"

namespace vp::detail {

#if defined(__AVX512F__) && defined(__AVX512VL__)
template <class T>
inline constexpr bool kByRows = kSlots<T> > 1;
#else
template <class T>
inline constexpr bool kByRows = false;
#endif

template <class T>
using Row = PackT<T, 8>;

template <int... I, class T, int N>
auto shuffled(const PackT<T, N>& a, const PackT<T, N>& b) {
  return PackT<T, static_cast<int>(sizeof...(I))>(__builtin_shufflevector(a.lanes, b.lanes, I...));
}

// Eight rows to eight columns.
template <class T>
void transpose_rows(Row<T> (&r)[8]) {
  const auto pairs = [](const Row<T>& a, const Row<T>& b, Row<T>& low, Row<T>& high) {
    low = shuffled<0, 8, 2, 10, 4, 12, 6, 14>(a, b);
    high = shuffled<1, 9, 3, 11, 5, 13, 7, 15>(a, b);
  };
  const auto fours = [](const Row<T>& a, const Row<T>& b, Row<T>& low, Row<T>& high) {
    low = shuffled<0, 1, 8, 9, 4, 5, 12, 13>(a, b);
    high = shuffled<2, 3, 10, 11, 6, 7, 14, 15>(a, b);
  };
  const auto halves = [](const Row<T>& a, const Row<T>& b, Row<T>& low, Row<T>& high) {
    low = shuffled<0, 1, 2, 3, 8, 9, 10, 11>(a, b);
    high = shuffled<4, 5, 6, 7, 12, 13, 14, 15>(a, b);
  };
  Row<T> s[8], t[8];
  for (int i = 0; i < 8; i += 2) pairs(r[i], r[i + 1], s[i], s[i + 1]);
  for (int i = 0; i < 8; i += 4) {
    fours(s[i], s[i + 2], t[i], t[i + 2]);
    fours(s[i + 1], s[i + 3], t[i + 1], t[i + 3]);
  }
  for (int i = 0; i < 4; ++i) halves(t[i], t[i + 4], r[i], r[i + 4]);
}

// A pose in four columns of four lanes, the last of no meaning.
template <class T>
struct ColumnPose {
  PackT<T, 4> x, y, z, p;

  static ColumnPose from(const T* at) {
    return {load<PackT<T, 4>>(at), load<PackT<T, 4>>(at + 4), load<PackT<T, 4>>(at + 8),
            load<PackT<T, 4>>(at + 12)};
  }
  void to(T* at) const {
    store(at, x);
    store(at + 4, y);
    store(at + 8, z);
    store(at + 12, p);
  }
  PackT<T, 4> turned(const Vec3T<T>& b) const {
    return (x * PackT<T, 4>(b.x) + y * PackT<T, 4>(b.y)) + z * PackT<T, 4>(b.z);
  }
  ColumnPose times(const SE3T<T>& B) const {
    const auto& R = B.rotation();
    return {turned(R.cx), turned(R.cy), turned(R.cz), p + turned(B.position())};
  }
};
template <class T>
alignas(64) inline constexpr T kOrigin[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0};
template <class T>
SE3T<T> pose_from(const T* at) {
  const auto column = [at](int i) { return Vec3T<T>{at[4 * i], at[4 * i + 1], at[4 * i + 2]}; };
  return {Mat3T<T>{column(0), column(1), column(2)}, column(3)};
}
template <class T>
void pose_to(T* at, const SE3T<T>& X) {
  const auto put = [](T* to, const Vec3T<T>& a) { to[0] = a.x, to[1] = a.y, to[2] = a.z; };
  put(at, X.rotation().cx);
  put(at + 4, X.rotation().cy);
  put(at + 8, X.rotation().cz);
  put(at + 12, X.position());
}

// Column i of the poses of eight slots, as three numbers of a group.
template <class T>
Vec3T<Row<T>> gathered(const T* rows, int stride, int column) {
  Row<T> r[4];
  for (int k = 0; k < 4; ++k) {
    const T* at = rows + k * stride + 4 * column;
    r[k] =
        shuffled<0, 1, 2, 3, 4, 5, 6, 7>(load<PackT<T, 4>>(at), load<PackT<T, 4>>(at + 4 * stride));
  }
  const auto s0 = shuffled<0, 8, 2, 10, 4, 12, 6, 14>(r[0], r[1]);
  const auto s1 = shuffled<1, 9, 3, 11, 5, 13, 7, 15>(r[0], r[1]);
  const auto s2 = shuffled<0, 8, 2, 10, 4, 12, 6, 14>(r[2], r[3]);
  const auto s3 = shuffled<1, 9, 3, 11, 5, 13, 7, 15>(r[2], r[3]);
  return {shuffled<0, 1, 8, 9, 4, 5, 12, 13>(s0, s2), shuffled<0, 1, 8, 9, 4, 5, 12, 13>(s1, s3),
          shuffled<2, 3, 10, 11, 6, 7, 14, 15>(s0, s2)};
}

// An articulated inertia by columns of (angular 3, linear 3, nothing 2).
template <class T>
struct ColumnInertia {
  Row<T> c[6];
};
template <class T>
ColumnInertia<T> operator+(const ColumnInertia<T>& a, const ColumnInertia<T>& b) {
  ColumnInertia<T> out;
  for (int k = 0; k < 6; ++k) out.c[k] = a.c[k] + b.c[k];
  return out;
}
// A body's, from I = (xx yy zz xy yz zx), mass, 0 and from (h, -h, 0, 0).
template <class T>
ColumnInertia<T> columns_of(const Row<T>& I, const Row<T>& h) {
  return {{shuffled<0, 3, 5, 14, 13, 9, 7, 7>(I, h), shuffled<3, 1, 4, 10, 14, 11, 7, 7>(I, h),
           shuffled<5, 4, 2, 12, 8, 14, 7, 7>(I, h), shuffled<7, 10, 12, 6, 7, 7, 7, 7>(I, h),
           shuffled<13, 7, 8, 7, 6, 7, 7, 7>(I, h), shuffled<9, 11, 7, 7, 7, 6, 7, 7>(I, h)}};
}

// What flows inwards.
template <class T>
struct ArticulatedRows {
  ColumnInertia<T> J;
  Row<T> p;
};
template <class T>
ArticulatedRows<T> operator+(const ArticulatedRows<T>& a, const ArticulatedRows<T>& b) {
  return {a.J + b.J, a.p + b.p};
}

// J S, as AInertiaT has it.
template <class T>
Row<T> times(const ColumnInertia<T>& J, const se3T<T>& S) {
  return ((J.c[0] * Row<T>(S.w.x) + J.c[1] * Row<T>(S.w.y)) + J.c[2] * Row<T>(S.w.z)) +
         ((J.c[3] * Row<T>(S.v.x) + J.c[4] * Row<T>(S.v.y)) + J.c[5] * Row<T>(S.v.z));
}

// J - U U^T / Omega.
template <class T>
ColumnInertia<T> without(const ColumnInertia<T>& J, const Row<T>& U, const T (&u)[8],
                         const T& inverse) {
  const Row<T> scale(inverse);
  ColumnInertia<T> out;
  for (int k = 0; k < 6; ++k) out.c[k] = J.c[k] - (Row<T>(u[k]) * U) * scale;
  return out;
}

// Numbers of a row, to be read one by one: from memory, where reading costs less than taking a
// register apart.
template <class T>
void spread(T (&to)[8], const Row<T>& row) {
  store(to, row);
  __asm__("" : "+m"(to));
}

}  // namespace vp::detail
