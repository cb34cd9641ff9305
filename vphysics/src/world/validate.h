// Checks of what callers hand in.
#pragma once

#include <optional>
#include <string>

#include "vphysics/world.h"

namespace vp {

// Largest magnitude accepted for a length, speed, angle or rate. Squares and products of such
// numbers stay far from overflow.
inline constexpr double kLargest = 1e9;

inline bool in_range(double x) {
  return std::isfinite(x) && std::fabs(x) <= kLargest;
}
inline bool in_range(const Vec3& a) {
  return in_range(a.x) && in_range(a.y) && in_range(a.z);
}
inline bool in_range(const se3& V) {
  return in_range(V.w) && in_range(V.v);
}

bool is_pose(const SE3& T);

// The sentence to return, or nothing when all is well.
std::optional<std::string> problem_with(const BodyDesc& desc);
std::optional<std::string> problem_with(const ColliderDesc& desc);
std::optional<std::string> problem_with(const LinkDesc& desc);
std::optional<std::string> problem_with(const JointDrive& drive);

}  // namespace vp
