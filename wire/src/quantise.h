// Quantises real numbers to the grids of wire/description.h, and back. Every input gives a valid
// code: values out of range saturate, values that are not finite become 0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "wire/description.h"

namespace wire {

// Nearest integer to value / step, clamped to low..high.
inline std::int64_t nearest_step(double value, double step, std::int64_t low, std::int64_t high) {
  if (!std::isfinite(value)) return 0;
  const double steps =
      std::clamp(value / step, static_cast<double>(low), static_cast<double>(high));
  return static_cast<std::int64_t>(steps + (steps < 0 ? -0.5 : 0.5));
}

inline std::uint64_t fixed_code(const Fixed& f, double value) {
  const std::int64_t steps = nearest_step(value, f.step, -f.zero(), f.max_code() - f.zero());
  return static_cast<std::uint64_t>(steps + f.zero());
}

inline double fixed_value(const Fixed& f, std::uint64_t code) {
  return f.step * static_cast<double>(static_cast<std::int64_t>(code) - f.zero());
}

inline std::uint64_t wrapped_code(const Wrapped& f, double angle) {
  if (!std::isfinite(angle)) return 0;
  const double lap = static_cast<double>(std::uint64_t{1} << f.bits);
  const double units = std::remainder(angle / kWrappedStep, lap);
  const std::int64_t nearest = static_cast<std::int64_t>(units + (units < 0 ? -0.5 : 0.5));
  return static_cast<std::uint64_t>(nearest) & ((std::uint64_t{1} << f.bits) - 1);
}

inline double wrapped_value(const Wrapped& f, std::uint64_t code) {
  const std::int64_t half = std::int64_t{1} << (f.bits - 1);
  const std::int64_t units =
      static_cast<std::int64_t>(code) - (static_cast<std::int64_t>(code) >= half ? 2 * half : 0);
  return kWrappedStep * static_cast<double>(units);
}

struct RotationCode {
  std::size_t largest = 3;
  std::array<std::uint64_t, 3> others{};
};

// Normalises a quaternion of any length except 0; otherwise uses the identity.
inline RotationCode rotation_code(const Rotation& f, const std::array<float, 4>& q) {
  std::array<double, 4> v{q[0], q[1], q[2], q[3]};
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
  if (!std::isfinite(length) || length == 0) v = {0, 0, 0, 1};
  const double unit = std::isfinite(length) && length > 0 ? length : 1.0;
  RotationCode code;
  code.largest = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (std::abs(v[i]) > std::abs(v[code.largest])) code.largest = i;
  }
  const double scale = (v[code.largest] < 0 ? -1.0 : 1.0) / unit;
  for (std::size_t i = 0, k = 0; i < 4; ++i) {
    if (i == code.largest) continue;
    const std::int64_t steps = nearest_step(v[i] * scale, f.step(), -f.zero(), f.zero());
    code.others[k++] = static_cast<std::uint64_t>(steps + f.zero());
  }
  return code;
}

// False unless the codes form a rotation whose largest component is the given one.
inline bool rotation_value(const Rotation& f, const RotationCode& code, std::array<float, 4>& q) {
  double sum = 0, greatest = 0;
  for (std::size_t i = 0, k = 0; i < 4; ++i) {
    if (i == code.largest) continue;
    const std::int64_t steps = static_cast<std::int64_t>(code.others[k++]) - f.zero();
    if (steps > f.zero()) return false;
    const double v = f.step() * static_cast<double>(steps);
    q[i] = static_cast<float>(v);
    sum += v * v;
    greatest = std::max(greatest, std::abs(v));
  }
  const double largest = sum < 1 ? std::sqrt(1 - sum) : 0;
  q[code.largest] = static_cast<float>(largest);
  return largest >= greatest - 3 * f.step();
}

}  // namespace wire
