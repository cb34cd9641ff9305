// Three floats of a body's state (body_state.h) as a vector, and back.
#pragma once

#include "vphysics/lie.h"

namespace vp {

inline Vec3 vector_of(const float* f) {
  return {static_cast<double>(f[0]), static_cast<double>(f[1]), static_cast<double>(f[2])};
}
inline void put(float* f, const Vec3& v) {
  f[0] = static_cast<float>(v.x);
  f[1] = static_cast<float>(v.y);
  f[2] = static_cast<float>(v.z);
}

}  // namespace vp
