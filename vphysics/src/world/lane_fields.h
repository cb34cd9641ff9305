// Access to one lane of the solver's fields.
#pragma once

#include "solve/field.h"
#include "vphysics/lie/vec3.h"

namespace vp {

inline double get(const solve::Field& field, int lane) {
  return static_cast<double>(field.lane[lane]);
}
inline Vec3 get(const solve::Field3& field, int lane) {
  return {get(field.x, lane), get(field.y, lane), get(field.z, lane)};
}
inline void put(solve::Field& field, int lane, double x) {
  field.lane[lane] = static_cast<float>(x);
}
inline void put(solve::Field3& field, int lane, const Vec3& v) {
  put(field.x, lane, v.x);
  put(field.y, lane, v.y);
  put(field.z, lane, v.z);
}

}  // namespace vp
