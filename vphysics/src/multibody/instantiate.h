// The scalars for which a library instantiates the algorithms, once: numbers in vphysics, packs in
// vphysics_packs, which is compiled from the same sources with VP_PACKS.
#pragma once

#include <cstddef>
#include <type_traits>

#include "vphysics/lie/pack.h"

namespace vp::detail {
using Double4 = PackT<double, 4>;
using Double8 = PackT<double, 8>;
using Float8 = PackT<float, 8>;
using Float16 = PackT<float, 16>;
}  // namespace vp::detail

#ifndef VP_PACKS
#define VP_FOR_EACH_SCALAR(X) \
  X(double)                   \
  X(float)
#elif defined(VP_FEW_SCALARS)  // builds for fault detection: the packs share one source
#define VP_FOR_EACH_SCALAR(X) X(detail::Double4)
#else
#define VP_FOR_EACH_SCALAR(X) \
  X(detail::Double4)          \
  X(detail::Double8)          \
  X(detail::Float8)           \
  X(detail::Float16)
#endif

namespace vp::detail {

// Index of T in VP_FOR_EACH_SCALAR.
template <class T>
constexpr std::size_t scalar_index() {
  std::size_t index = 0, found = 0;
#define VP_LOOK_AT(Scalar)                      \
  if (std::is_same_v<T, Scalar>) found = index; \
  ++index;
  VP_FOR_EACH_SCALAR(VP_LOOK_AT)
#undef VP_LOOK_AT
  return found;
}

}  // namespace vp::detail
