// One state in registers of eight numbers: products and sums along the tree, within a group.
//
// A slot's pose depends on its parent's. In a group of eight, a chain has up to eight dependent
// steps. Doubling (ScanStep) needs three steps, each in all lanes: more operations than in
// sequence, but full registers and a third of the latency.
#pragma once

#include "multibody/work.h"

#if defined(__AVX512F__) && defined(__AVX512VL__)
#include <immintrin.h>

namespace vp::detail {

// Takes lanes of a as the step specifies; of `others` for lanes without an ancestor.
inline PackT<double, 8> taken(const ScanStep<double>& step, const PackT<double, 8>& a,
                              const PackT<double, 8>& others) {
  using Lanes = PackT<double, 8>::Lanes;
  return PackT<double, 8>(static_cast<Lanes>(
      _mm512_mask_permutexvar_pd(others.lanes, step.lanes, _mm512_load_si512(step.from), a.lanes)));
}
inline PackT<float, 8> taken(const ScanStep<float>& step, const PackT<float, 8>& a,
                             const PackT<float, 8>& others) {
  using Lanes = PackT<float, 8>::Lanes;
  return PackT<float, 8>(static_cast<Lanes>(_mm256_mask_permutexvar_ps(
      others.lanes, step.lanes, _mm256_load_si256(reinterpret_cast<const __m256i*>(step.from)),
      a.lanes)));
}
// Broadcasts a number to the lanes of an external parent; `others` in the other lanes.
inline PackT<double, 8> spread_to(const External& external, double x,
                                  const PackT<double, 8>& others) {
  return PackT<double, 8>(static_cast<PackT<double, 8>::Lanes>(
      _mm512_mask_broadcastsd_pd(others.lanes, external.lanes, _mm_set_sd(x))));
}
inline PackT<float, 8> spread_to(const External& external, float x, const PackT<float, 8>& others) {
  return PackT<float, 8>(static_cast<PackT<float, 8>::Lanes>(
      _mm256_mask_broadcastss_ps(others.lanes, external.lanes, _mm_set_ss(x))));
}

// Maps each component of a pose by f(component, the component of the identity).
template <class N, class M, class F>
SE3T<N> each_number(const SE3T<M>& X, const F& f) {
  const N zero(0), one(1);
  const Mat3T<M>& R = X.rotation();
  const Vec3T<M>& p = X.position();
  return {Mat3T<N>{{f(R.cx.x, one), f(R.cx.y, zero), f(R.cx.z, zero)},
                   {f(R.cy.x, zero), f(R.cy.y, one), f(R.cy.z, zero)},
                   {f(R.cz.x, zero), f(R.cz.y, zero), f(R.cz.z, one)}},
          {f(p.x, zero), f(p.y, zero), f(p.z, zero)}};
}
template <class N, class M, class F>
se3T<N> each_number(const se3T<M>& V, const F& f) {
  const N zero(0);
  return {{f(V.w.x, zero), f(V.w.y, zero), f(V.w.z, zero)},
          {f(V.v.x, zero), f(V.v.y, zero), f(V.v.z, zero)}};
}

template <class B, class N>
SE3T<N> multiplied_in_group(const Layout<B>& layout, const typename Layout<B>::Group& group,
                            SE3T<N> X) {
  for (int s = group.first_step; s < group.end_step; ++s) {
    const auto& step = layout.steps[static_cast<std::size_t>(s)];
    X = each_number<N>(X, [&](const N& x, const N& unit) { return taken(step, x, unit); }) * X;
  }
  return X;
}
template <class B, class N>
se3T<N> summed_in_group(const Layout<B>& layout, const typename Layout<B>::Group& group,
                        se3T<N> V) {
  for (int s = group.first_step; s < group.end_step; ++s) {
    const auto& step = layout.steps[static_cast<std::size_t>(s)];
    V = each_number<N>(V, [&](const N& x, const N& zero) { return taken(step, x, zero); }) + V;
  }
  return V;
}
// A pose in the lanes of an external parent; P in the others.
template <class T, class N>
SE3T<N> pose_in_lanes(const External& external, const SE3T<T>& X, const SE3T<N>& P) {
  const auto column = [&](const Vec3T<T>& a, const Vec3T<N>& others) {
    return Vec3T<N>{spread_to(external, a.x, others.x), spread_to(external, a.y, others.y),
                    spread_to(external, a.z, others.z)};
  };
  const Mat3T<T>& R = X.rotation();
  const Mat3T<N>& Q = P.rotation();
  return {Mat3T<N>{column(R.cx, Q.cx), column(R.cy, Q.cy), column(R.cz, Q.cz)},
          column(X.position(), P.position())};
}
template <class T>
se3T<Wide<T>> in_blocks(const External& external, const se3T<T>& V) {
  return each_number<Wide<T>>(
      V, [&](const T& x, const Wide<T>& zero) { return spread_to(external, x, zero); });
}

}  // namespace vp::detail
#endif
