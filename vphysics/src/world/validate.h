// Validation of arguments.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>

#include "vphysics/world.h"

namespace vp {

class Articulation;

// Max magnitude accepted for a length, speed, angle or rate. Squares and products of such numbers
// stay far from overflow.
inline constexpr double kLargest = 1e9;
// Min sizes of shapes [m], masses [kg] and moments of inertia [kg m^2] of bodies: a water drop of a
// micrometre. In single precision the solver's inverses keep headroom for products with lever arms.
inline constexpr double kMinSize = 1e-6, kMinMass = 1e-15, kMinMoment = 1e-30;
// Valid step lengths [s]. In the shortest step gravity adds eight ulps to a speed of 1 m/s in
// single precision. With 1000 sub-steps of it, a separation of kLargest divided by the sub-step
// length stays far within the range of single precision.
inline constexpr double kShortestStep = 1e-7, kLongestStep = 0.1;

inline bool in_range(double x) {
  return std::fabs(x) <= kLargest;  // false for NaN, too
}
inline bool in_range(const Vec3& a) {
  return in_range(a.x) && in_range(a.y) && in_range(a.z);
}
inline bool in_range(const se3& V) {
  return in_range(V.w) && in_range(V.v);
}
// For vectors that are in range in their own frame, or at the limit of the range. In world axes an
// entry may be sqrt(3) times larger. The test does not depend on the frame.
inline bool nearly_in_range(const Vec3& a) {
  return dot(a, a) <= 4.0 * kLargest * kLargest;
}

bool is_pose(const SE3& T);
inline bool is_gravity_scale(double scale) {
  return in_range(1e3 * scale);
}
// Whether the body takes its mass from its colliders.
bool has_no_inertia(const BodyDesc& desc);
// Checks all ball and free joints.
bool has_unit_quaternions(const Model& model, std::span<const double> q);

// The sentence to return, or nothing if the argument is valid.
std::optional<std::string> problem_with(const WorldDesc& desc);
std::optional<std::string> problem_with(const BodyDesc& desc);
std::optional<std::string> problem_with(const Inertia& inertia);
std::optional<std::string> problem_with(const Material& material);
std::optional<std::string> problem_with(const ColliderDesc& desc);
std::optional<std::string> problem_with_shape(const Shape& shape);
std::optional<std::string> problem_with(const ArticulationDesc& desc);
// With other coordinates and velocities.
std::optional<std::string> problem_with(const Articulation& articulation, std::span<const double> q,
                                        std::span<const double> v);
// Drives are set in every step, so the test constructs no string.
inline constexpr double kStiffest = 1e15;  // [N/m, N s/m]: above it steps make no difference
inline bool is_drive(const JointDrive& drive) {
  const auto up_to = [](double x, double max_value) { return x >= 0.0 && x <= max_value; };
  return in_range(drive.position) && in_range(drive.velocity) &&
         up_to(drive.stiffness, kStiffest) && up_to(drive.damping, kStiffest) &&
         up_to(drive.max_force, std::numeric_limits<double>::max());
}
std::optional<std::string> problem_with(const JointDrive& drive);
// Why a link's joint rejects this drive. exists: whether it has that degree of freedom.
std::string why_no_drive(bool exists, const JointDrive& drive);

}  // namespace vp
