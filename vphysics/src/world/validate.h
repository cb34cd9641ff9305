// Checks of what callers hand in.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>

#include "vphysics/world.h"

namespace vp {

class Articulation;

// Largest magnitude accepted for a length, speed, angle or rate. Squares and products of such
// numbers stay far from overflow.
inline constexpr double kLargest = 1e9;
// Least sizes of shapes [m], masses [kg] and moments of inertia [kg m^2] of bodies: a water drop of
// a micrometre. The solver's single precision holds the inverses with room for products with arms.
inline constexpr double kMinSize = 1e-6, kMinMass = 1e-15, kMinMoment = 1e-30;
// Times that a step may take [s]. In the least one gravity adds eight last bits to a speed of 1 m/s
// in single precision, and 1000 sub-steps of it leave gaps of kLargest, divided by their length,
// far within its range.
inline constexpr double kShortestStep = 1e-7, kLongestStep = 0.1;

inline bool in_range(double x) {
  return std::fabs(x) <= kLargest;  // false for what is no number, too
}
inline bool in_range(const Vec3& a) {
  return in_range(a.x) && in_range(a.y) && in_range(a.z);
}
inline bool in_range(const se3& V) {
  return in_range(V.w) && in_range(V.v);
}
// Of what is in range in a frame of its own, or lies at the edge of what is: turned into the
// world's axes an entry may be the square root of three times as large. The same in any frame.
inline bool nearly_in_range(const Vec3& a) {
  return dot(a, a) <= 4.0 * kLargest * kLargest;
}

bool is_pose(const SE3& T);
inline bool is_gravity_scale(double scale) {
  return in_range(1e3 * scale);
}
// The body takes its mass from its colliders.
bool has_no_inertia(const BodyDesc& desc);
// Of all ball and free joints.
bool has_unit_quaternions(const Model& model, std::span<const double> q);

// The sentence to return, or nothing when all is well.
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
// Drives are set at every step: whether there is a problem costs no string.
inline constexpr double kStiffest = 1e15;  // [N/m, N s/m]: beyond it steps cannot tell a difference
inline bool is_drive(const JointDrive& drive) {
  const auto up_to = [](double x, double max_value) { return x >= 0.0 && x <= max_value; };
  return in_range(drive.position) && in_range(drive.velocity) &&
         up_to(drive.stiffness, kStiffest) && up_to(drive.damping, kStiffest) &&
         up_to(drive.max_force, std::numeric_limits<double>::max());
}
std::optional<std::string> problem_with(const JointDrive& drive);
// Of a link's joint that refuses this drive; exists: it has that degree of freedom.
std::string why_no_drive(bool exists, const JointDrive& drive);

}  // namespace vp
