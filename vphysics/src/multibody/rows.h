// One state in registers of eight numbers: the recursions by rows.
//
// In the tip-to-base pass slots depend on each other, so the recursions of one state cannot assign
// a lane to each slot as the rest of a pass does (lanes.h). With 512-bit registers they assign
// lanes to the numbers of one slot instead: a force is one register, an articulated inertia six.
#pragma once

#include "multibody/lanes.h"

namespace vp::detail {

#if defined(__AVX512F__) && defined(__AVX512VL__) && !defined(VP_SAME_BITS)
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

// Transposes an 8x8 block.
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

// A 6-vector of one slot, as the child accumulation adds them: in a row, where rows are used.
template <class T>
struct SixRow {
  Row<T> row;

  static SixRow from(const T* at) { return {load<Row<T>>(at)}; }
  void to(T* at) const { store(at, row); }
  friend SixRow operator+(const SixRow& a, const SixRow& b) { return {a.row + b.row}; }
};
template <class T>
struct Six {
  T x[6];

  static Six of(const Vec3T<T>& a, const Vec3T<T>& b) { return {{a.x, a.y, a.z, b.x, b.y, b.z}}; }
  static Six from(const T* at) { return {{at[0], at[1], at[2], at[3], at[4], at[5]}}; }
  void to(T* at) const {
    for (int c = 0; c < 6; ++c) at[c] = x[c];
  }
  Vec3T<T> head() const { return {x[0], x[1], x[2]}; }
  Vec3T<T> tail() const { return {x[3], x[4], x[5]}; }
  friend Six operator+(const Six& a, const Six& b) {
    return of(a.head() + b.head(), a.tail() + b.tail());
  }
};
template <class T>
using ChainSix = std::conditional_t<kByRows<T>, SixRow<T>, Six<T>>;

// split: from two vectors for each slot of a group to one 6-vector for each slot; join: the
// inverse.
template <class T>
void split(const Vec3T<Wide<T>>& a, const Vec3T<Wide<T>>& b, ChainSix<T> (&out)[kSlots<T>]) {
  if constexpr (kSlots<T> == 1) {
    out[0] = ChainSix<T>::of(a, b);
  } else if constexpr (kByRows<T>) {
    Row<T> r[8] = {a.x, a.y, a.z, b.x, b.y, b.z, Row<T>(0), Row<T>(0)};
    transpose_rows(r);
    for (int k = 0; k < 8; ++k) out[k].row = r[k];
  } else {
    alignas(64) T numbers[6 * kSlots<T>];
    const Fields<T, Wide<T>> fields(numbers);
    fields.set(0, a);
    fields.set(3, b);
    for (int k = 0; k < kSlots<T>; ++k) {
      const Fields<T, T> slot(numbers + k);
      out[k] = Six<T>::of(slot.vec(0), slot.vec(3));
    }
  }
}
template <class T>
void join(const ChainSix<T> (&x)[kSlots<T>], Vec3T<Wide<T>>& a, Vec3T<Wide<T>>& b) {
  if constexpr (kSlots<T> == 1) {
    a = x[0].head();
    b = x[0].tail();
  } else if constexpr (kByRows<T>) {
    Row<T> r[8];
    for (int k = 0; k < 8; ++k) r[k] = x[k].row;
    transpose_rows(r);
    a = {r[0], r[1], r[2]};
    b = {r[3], r[4], r[5]};
  } else {
    alignas(64) T numbers[6 * kSlots<T>];
    for (int k = 0; k < kSlots<T>; ++k) {
      const Fields<T, T> slot(numbers + k);
      slot.set(0, x[k].head());
      slot.set(3, x[k].tail());
    }
    const Fields<T, Wide<T>> fields(numbers);
    a = fields.vec(0);
    b = fields.vec(3);
  }
}

// An articulated inertia by columns of (angular 3, linear 3, unused 2).
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
// The inertia of a body, from I = (xx yy zz xy yz zx), mass, 0 and from (h, -h, 0, 0).
template <class T>
ColumnInertia<T> columns_of(const Row<T>& I, const Row<T>& h) {
  return {{shuffled<0, 3, 5, 14, 13, 9, 7, 7>(I, h), shuffled<3, 1, 4, 10, 14, 11, 7, 7>(I, h),
           shuffled<5, 4, 2, 12, 8, 14, 7, 7>(I, h), shuffled<7, 10, 12, 6, 7, 7, 7, 7>(I, h),
           shuffled<13, 7, 8, 7, 6, 7, 7, 7>(I, h), shuffled<9, 11, 7, 7, 7, 6, 7, 7>(I, h)}};
}

// The load of the child accumulation.
template <class T>
struct ArticulatedRows {
  ColumnInertia<T> J;
  Row<T> p;
};
template <class T>
ArticulatedRows<T> operator+(const ArticulatedRows<T>& a, const ArticulatedRows<T>& b) {
  return {a.J + b.J, a.p + b.p};
}

// J S, like AInertiaT.
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

// Writes a row to memory, to read its numbers one by one: this costs less than extracting them from
// a register.
template <class T>
void spread(T (&to)[8], const Row<T>& row) {
  store(to, row);
  __asm__("" : "+m"(to));
}

}  // namespace vp::detail
