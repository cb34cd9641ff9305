// How the passes use SIMD lanes.
//
// Each pass is written once. Where it processes joints one after another it computes with T. Where
// it processes all joints alike it computes with Wide<T>. For a pack of states Wide<T> is T: the
// lanes are states. For one state the lanes are eight joints.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>

#if defined(__AVX512F__) && defined(__AVX512VL__)
#include <immintrin.h>
#endif

#include "vphysics/lie/ainertia.h"
#include "vphysics/lie/pack.h"

// With wide registers, a pass is compiled as one function: everything it calls is inlined, so that
// values stay in registers. Without them, the lanes of a pack exceed the registers anyway, and
// inlining would only make compilation slow. Code that a pass rarely needs is not inlined.
#ifdef __AVX2__
#define VP_FLATTEN [[gnu::flatten]]
#else
#define VP_FLATTEN
#endif
#define VP_NOINLINE [[gnu::noinline]]

namespace vp::detail {

template <class T>
struct WideOf {
  using type = PackT<T, 8>;
  static constexpr int kSlots = 8;
};
template <class B, int N>
struct WideOf<PackT<B, N>> {
  using type = PackT<B, N>;
  static constexpr int kSlots = 1;
};
template <class T>
using Wide = typename WideOf<T>::type;
// Number of slots (tree.h) in one Wide<T>.
template <class T>
inline constexpr int kSlots = WideOf<T>::kSlots;

// Loads from an aligned address. The access has the type of the numbers, so it cannot alias
// pointers or counters: the compiler may keep those in registers.
template <class N, class T>
inline N load(const T* from) {
  if constexpr (std::is_same_v<N, T>) {
    return *from;
  } else {
    return N(*reinterpret_cast<const typename N::Lanes*>(from));
  }
}
template <class N, class T>
inline void store(T* to, const N& x) {
  if constexpr (std::is_same_v<N, T>) {
    *to = x;
  } else {
    *reinterpret_cast<typename N::Lanes*>(to) = x.lanes;
  }
}
// Loads `count` numbers from an array of `size` remaining numbers. The other lanes are unspecified.
template <class N, class T>
inline N load_until(const T* from, int size, int count) {
  N x(T(0));
  if (size >= N::kLanes) {
    std::memcpy(static_cast<void*>(&x), from, sizeof x);
    return x;
  }
#if defined(__AVX512F__) && defined(__AVX512VL__)
  const auto mask = static_cast<__mmask8>((1 << count) - 1);
  if constexpr (std::is_same_v<N, PackT<double, 8>>) {
    x.lanes = static_cast<typename N::Lanes>(_mm512_maskz_loadu_pd(mask, from));
    return x;
  } else if constexpr (std::is_same_v<N, PackT<float, 8>>) {
    x.lanes = static_cast<typename N::Lanes>(_mm256_maskz_loadu_ps(mask, from));
    return x;
  }
#endif
  for (int k = 0; k < count; ++k) x.set(k, from[k]);
  return x;
}

// Stores lanes begin to end - 1; lane 0 corresponds to to[0]. Other elements are unchanged.
template <class N, class T>
inline void store_lanes(T* to, const N& x, [[maybe_unused]] int begin, [[maybe_unused]] int end) {
  if constexpr (std::is_same_v<N, T>) {
    *to = x;
    return;
  } else {
#if defined(__AVX512F__) && defined(__AVX512VL__)
    const auto mask = static_cast<__mmask8>((1 << end) - (1 << begin));
    if constexpr (std::is_same_v<N, PackT<double, 8>>) {
      _mm512_mask_storeu_pd(to, mask, x.lanes);
      return;
    } else if constexpr (std::is_same_v<N, PackT<float, 8>>) {
      _mm256_mask_storeu_ps(to, mask, x.lanes);
      return;
    }
#endif
    for (int k = begin; k < end; ++k) to[k] = x[k];
  }
}

// Replaces one lane, in the register: a partial write to memory would stall the next read of the
// whole vector.
template <class B, int N>
inline void set_lane_of(PackT<B, N>& to, int k, B x) {
#if defined(__AVX512F__) && defined(__AVX512VL__)
  using Lanes = typename PackT<B, N>::Lanes;
  const auto lane = static_cast<__mmask8>(1 << k);
  if constexpr (std::is_same_v<PackT<B, N>, PackT<double, 8>>) {
    to.lanes = static_cast<Lanes>(_mm512_mask_broadcastsd_pd(to.lanes, lane, _mm_set_sd(x)));
    return;
  } else if constexpr (std::is_same_v<PackT<B, N>, PackT<float, 8>>) {
    to.lanes = static_cast<Lanes>(_mm256_mask_broadcastss_ps(to.lanes, lane, _mm_set_ss(x)));
    return;
  }
#endif
  to.set(k, x);
}
template <class B, int N>
inline void set_lane_of(Vec3T<PackT<B, N>>& to, int k, const Vec3T<B>& a) {
  for (int c = 0; c < 3; ++c) set_lane_of(to[c], k, a[c]);
}

// An array aligned to cache lines, initialised with zeros.
template <class T>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size) : size_(size) {
    static_assert(alignof(T) <= kAlignment);
    data_.reset(new (std::align_val_t{kAlignment}) T[size]());
  }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t kAlignment = 64;
  struct Delete {
    void operator()(T* p) const { operator delete[](p, std::align_val_t{kAlignment}); }
  };
  std::unique_ptr<T[], Delete> data_;
  std::size_t size_ = 0;
};

// Fields of one slot, or of a group of kSlots slots. Field f of a slot is kSlots elements after
// field f - 1. N is T for a slot and Wide<T> for a group, whose fields start at those of its first
// slot.
template <class T, class N>
class Fields {
 public:
  explicit Fields(T* at) : at_(at) {}

  N get(int f) const { return load<N>(at_ + f * kSlots<T>); }
  Vec3T<N> vec(int f) const { return {get(f), get(f + 1), get(f + 2)}; }
  se3T<N> twist(int f) const { return {vec(f), vec(f + 3)}; }
  dse3T<N> wrench(int f) const { return {vec(f), vec(f + 3)}; }
  Mat3T<N> mat(int f) const { return {vec(f), vec(f + 3), vec(f + 6)}; }
  SE3T<N> pose(int f) const { return {mat(f), vec(f + 9)}; }
  Sym3T<N> sym(int f) const {
    return {get(f), get(f + 1), get(f + 2), get(f + 3), get(f + 4), get(f + 5)};
  }

  void set(int f, const N& x) const { store(at_ + f * kSlots<T>, x); }
  void set(int f, const Vec3T<N>& a) const {
    set(f, a.x);
    set(f + 1, a.y);
    set(f + 2, a.z);
  }
  void set(int f, const se3T<N>& V) const {
    set(f, V.w);
    set(f + 3, V.v);
  }
  void set(int f, const dse3T<N>& F) const {
    set(f, F.m);
    set(f + 3, F.f);
  }
  void set(int f, const SE3T<N>& X) const {
    set(f, X.rotation().cx);
    set(f + 3, X.rotation().cy);
    set(f + 6, X.rotation().cz);
    set(f + 9, X.position());
  }
  void set(int f, const Sym3T<N>& A) const {
    set(f, Vec3T<N>{A.xx, A.yy, A.zz});
    set(f + 3, Vec3T<N>{A.xy, A.yz, A.zx});
  }

 private:
  T* at_;
};

// The same for a model's constants, which all states share.
template <class T, class N>
class Constants {
 public:
  explicit Constants(const base_t<T>* at) : at_(at) {}

  N get(int f) const {
    if constexpr (kSlots<T> == 1) {
      return N(at_[f]);
    } else {
      return load<N>(at_ + f * kSlots<T>);
    }
  }
  Vec3T<N> vec(int f) const { return {get(f), get(f + 1), get(f + 2)}; }
  Mat3T<N> mat(int f) const { return {vec(f), vec(f + 3), vec(f + 6)}; }

 private:
  const base_t<T>* at_;
};

}  // namespace vp::detail
