#include "world/validate.h"

#include <algorithm>
#include <cmath>

#include "world/articulation.h"

namespace vp {
namespace {

constexpr const char* kRange = " must be finite and at most 1e9 in magnitude";

bool positive(double x) {
  return in_range(x) && x > 0.0;
}
bool is_size(double x) {
  return in_range(x) && x >= kMinSize;
}
bool not_negative(double x) {
  return in_range(x) && x >= 0.0;
}

// Positive definite by its leading minors.
bool positive_definite(const Sym3& A) {
  const double minor = A.xx * A.yy - A.xy * A.xy;
  const double determinant = A.xx * (A.yy * A.zz - A.yz * A.yz) -
                             A.xy * (A.xy * A.zz - A.yz * A.zx) +
                             A.zx * (A.xy * A.yz - A.yy * A.zx);
  return A.xx > 0.0 && minor > 0.0 && determinant > 0.0;
}

bool in_range(const Sym3& A) {
  return vp::in_range(Vec3{A.xx, A.yy, A.zz}) && vp::in_range(Vec3{A.xy, A.yz, A.zx});
}

}  // namespace

std::optional<std::string> problem_with_shape(const Shape& shape) {
  if (const auto* s = std::get_if<Sphere>(&shape)) {
    if (!is_size(s->radius)) return "sphere: the radius must be from 1e-6 to 1e9 m";
  } else if (const auto* b = std::get_if<Box>(&shape)) {
    const Vec3& h = b->half_extents;
    if (!is_size(h.x) || !is_size(h.y) || !is_size(h.z)) {
      return "box: every half extent must be from 1e-6 to 1e9 m";
    }
  } else if (const auto* c = std::get_if<Capsule>(&shape)) {
    if (!is_size(c->radius)) return "capsule: the radius must be from 1e-6 to 1e9 m";
    if (!not_negative(c->half_length)) return "capsule: the half length must be from 0 to 1e9 m";
  } else if (const auto* y = std::get_if<Cylinder>(&shape)) {
    if (!is_size(y->radius)) return "cylinder: the radius must be from 1e-6 to 1e9 m";
    if (!is_size(y->half_length)) return "cylinder: the half length must be from 1e-6 to 1e9 m";
  } else if (const auto* k = std::get_if<Cone>(&shape)) {
    if (!is_size(k->radius)) return "cone: the radius must be from 1e-6 to 1e9 m";
    if (!is_size(k->half_height)) return "cone: the half height must be from 1e-6 to 1e9 m";
  } else if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
    if (!hull->data()) return "convex hull: it was moved from; give a copy";
  } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
    if (!mesh->data()) return "triangle mesh: it was moved from; give a copy";
  } else if (const auto* field = std::get_if<HeightField>(&shape)) {
    if (!field->data()) return "height field: it was moved from; give a copy";
  } else if (const auto* compound = std::get_if<Compound>(&shape)) {
    if (!compound->data()) return "compound: it was moved from; give a copy";
  }
  return std::nullopt;
}

bool is_pose(const SE3& T) {
  constexpr double kTolerance = 1e-6;
  const Mat3& R = T.rotation();
  if (!in_range(T.position()) || !in_range(R.cx) || !in_range(R.cy) || !in_range(R.cz))
    return false;
  const Vec3 d = cross(R.cx, R.cy) - R.cz;
  return std::fabs(dot(R.cx, R.cx) - 1.0) < kTolerance &&
         std::fabs(dot(R.cy, R.cy) - 1.0) < kTolerance && std::fabs(dot(R.cx, R.cy)) < kTolerance &&
         norm(d) < kTolerance;
}

bool has_unit_quaternions(const Model& model, std::span<const double> q) {
  for (int l = 0; l < model.links(); ++l) {
    const Joint& joint = model.link(l).joint;
    const int n = coordinates_of(joint);
    if (n == velocities_of(joint)) continue;
    const int behind = model.first_coordinate(l) + n;
    const auto end = static_cast<std::size_t>(behind);
    double square = 0.0;
    for (std::size_t k = end - 4; k < end; ++k) square += q[k] * q[k];
    if (!(std::fabs(square - 1.0) < 1e-6)) return false;
  }
  return true;
}

// Each limit is far beyond practical use. Together they bound the time of a step for untrusted
// descriptions.
std::optional<std::string> problem_with(const WorldDesc& desc) {
  if (!in_range(desc.gravity)) return "gravity must be finite and at most 1e9 m/s^2";
  if (!in_range(desc.restitution_threshold) || desc.restitution_threshold < 0.0)
    return "restitution_threshold must be from 0 to 1e9 m/s";
  if (!in_range(desc.contact_slop) || !(desc.contact_slop > 0.0))
    return "contact_slop must be positive and at most 1e9 m";
  if (!in_range(desc.sleep_after) || desc.sleep_after < 0.0)
    return "sleep_after must be from 0 (never) to 1e9 s";
  if (!in_range(desc.sleep_speed) || desc.sleep_speed < 0.0)
    return "sleep_speed must be from 0 to 1e9 m/s";
  if (desc.velocity_iterations < 1 || desc.velocity_iterations > 1000)
    return "velocity_iterations must be from 1 to 1000";
  if (desc.sub_steps < 0 || desc.sub_steps > 1000)
    return "sub_steps must be from 0 (as the step needs) to 1000";
  if (desc.max_impacts_per_step < 0 || desc.max_impacts_per_step > 100000)
    return "max_impacts_per_step must be from 0 to 100000";
  if (!(desc.length_unit >= 1e-6 && desc.length_unit <= 1e6))
    return "length_unit must be from 1e-6 to 1e6 m";
  if (desc.region_bodies < 1 || desc.region_bodies > 1000000)
    return "region_bodies must be from 1 to 1000000";
  return std::nullopt;
}

bool has_no_inertia(const BodyDesc& desc) {
  const Inertia& J = desc.inertia;
  const Sym3& I = J.rotational();
  return J.mass() == 0.0 && J.first_moment() == Vec3{} && I == Sym3{};
}

std::optional<std::string> problem_with(const BodyDesc& desc) {
  if (!is_pose(desc.T_world_body)) return "T_world_body must be a finite rotation and position";
  if (!in_range(desc.velocity)) return std::string("velocity") + kRange;
  if (desc.motion > Motion::dynamic) return "motion must be fixed, kinematic or dynamic";
  if (!not_negative(desc.linear_damping) || !not_negative(desc.angular_damping)) {
    return "damping must be zero or more";
  }
  if (!is_gravity_scale(desc.gravity_scale)) {
    return "gravity_scale must be finite and at most 1e6 either way";
  }
  if (has_no_inertia(desc)) return std::nullopt;
  if (desc.motion != Motion::dynamic) {
    const Sym3& I = desc.inertia.rotational();
    const bool finite = std::isfinite(desc.inertia.mass() + norm(desc.inertia.first_moment()) +
                                      I.xx + I.yy + I.zz + I.xy + I.yz + I.zx);
    if (finite) return std::nullopt;
    return "inertia: every number must be finite";
  }
  if (auto problem = problem_with(desc.inertia)) return problem;
  const se3& V = desc.velocity;
  if (!nearly_in_range(V.v + cross(V.w, desc.inertia.centre_of_mass()))) {
    return "velocity: the centre of mass would move faster than 1e9 m/s";
  }
  return std::nullopt;
}

// Max: the moment of the max mass at a radius of gyration of a kilometre.
bool is_moment(const Sym3& J) {
  constexpr double kMax = 1e15;
  return in_range((kLargest / kMax) * Vec3{J.xx, J.yy, J.zz}) &&
         in_range((kLargest / kMax) * Vec3{J.xy, J.yz, J.zx});
}
// Second moments of a mass, (tr J) 1 / 2 - J, must not be negative, with a tolerance for numbers
// rounded to two digits.
bool is_of_mass(const Sym3& J) {
  constexpr double kRounding = 0.01;
  const double half = (0.5 + kRounding) * (J.xx + J.yy + J.zz);
  return positive_definite({half - J.xx, half - J.yy, half - J.zz, -J.xy, -J.yz, -J.zx});
}

std::optional<std::string> problem_with(const Inertia& J) {
  if (!in_range(J.mass()) || !(J.mass() >= kMinMass)) {
    return "inertia: the mass must be from 1e-15 to 1e9 kg; set a mass or use solid_inertia";
  }
  if (!in_range(J.centre_of_mass()) || !is_moment(J.central())) {
    return "inertia: the centre of mass must be within 1e9 m, every moment about it within "
           "1e15 kg m^2";
  }
  if (!positive_definite(J.central())) {
    return "inertia: the rotational part about the centre of mass must be positive definite; is it "
           "given about the body's origin?";
  }
  if (!is_of_mass(J.central())) {
    return "inertia: no mass has such moments about its centre: the largest principal moment may "
           "not "
           "exceed the sum of the other two by more than 4 %; use solid_inertia";
  }
  const Sym3 inverse_central = inverse(J.central());
  const double largest = std::max({inverse_central.xx, inverse_central.yy, inverse_central.zz});
  if (!(largest * kMinMoment <= 1.0 + 1e-9)) {
    return "inertia: the moments about the centre of mass must be at least 1e-30 kg m^2; use "
           "solid_inertia, or another unit of length";
  }
  return std::nullopt;
}

std::optional<std::string> problem_with(const Material& m) {
  if (!not_negative(m.friction)) return "material: friction must be zero or more";
  if (!(m.restitution >= 0.0 && m.restitution <= 1.0))
    return "material: restitution must be in [0, 1]";
  if (!not_negative(m.rolling_friction)) return "material: rolling friction must be zero or more";
  if (!not_negative(m.spinning_friction)) return "material: spinning friction must be zero or more";
  return std::nullopt;
}

std::optional<std::string> problem_with(const ColliderDesc& desc) {
  if (auto problem = problem_with_shape(desc.shape)) return problem;
  if (!is_pose(desc.T_body_shape)) return "T_body_shape must be a finite rotation and position";
  if (auto problem = problem_with(desc.material)) return problem;
  if (!in_range(desc.surface_velocity)) return std::string("surface_velocity") + kRange;
  if (!positive(desc.density)) return "density must be positive and finite";
  return std::nullopt;
}

std::optional<std::string> problem_with(const ArticulationDesc& desc) {
  const Model& model = desc.model;
  for (int l = 0; l < model.links(); ++l) {
    const LinkSpec& link = model.link(l);
    const Inertia& J = link.inertia;
    if (!in_range(J.mass()) || !in_range(J.first_moment()) || !in_range(J.rotational()) ||
        !in_range(link.T_parent_joint.position()) || !in_range(link.armature) ||
        !in_range(link.damping)) {
      return "link " + std::to_string(l) + ": every number of the model" + kRange;
    }
    for (const JointForces& f : link.forces) {
      const bool valid_limits = f.lower < kLargest && f.upper > -kLargest && f.lower <= f.upper;
      if (!valid_limits || !in_range(f.rest) || !(f.stiffness <= 1e30) ||
          !(f.limit_damping <= 1e30)) {
        return "link " + std::to_string(l) +
               ": limits and the spring's rest must lie within 1e9, stiffness within 1e30";
      }
    }
  }
  return std::nullopt;
}

std::optional<std::string> problem_with(const Articulation& art, std::span<const double> q,
                                        std::span<const double> v) {
  if (q.size() != art.q.size() || v.size() != art.v.size()) {
    return "as many coordinates and velocities are needed as the model has";
  }
  const auto good = [](double x) { return in_range(x); };
  if (!std::all_of(q.begin(), q.end(), good) || !std::all_of(v.begin(), v.end(), good)) {
    return std::string("every coordinate and velocity") + kRange;
  }
  for (const JointDof& dof : art.dofs) {
    if (dof.coordinate < 0) continue;
    const double x = q[static_cast<std::size_t>(dof.coordinate)];
    if (x < dof.lower || x > dof.upper) {
      return "every coordinate must lie between its joint's stops";
    }
  }
  if (!has_unit_quaternions(art.model(), q)) {
    return "the quaternion of a ball or a free joint must be of unit length";
  }
  return std::nullopt;
}

std::optional<std::string> problem_with(const JointDrive& drive) {
  if (is_drive(drive)) return std::nullopt;
  if (!in_range(drive.position) || !in_range(drive.velocity)) {
    return std::string("drive: position and velocity") + kRange;
  }
  const auto gain = [](double x) { return x >= 0.0 && x <= kStiffest; };
  if (!gain(drive.stiffness) || !gain(drive.damping)) {
    return "drive: stiffness and damping must be from 0 to 1e15";
  }
  return "drive: max_force must be finite and zero or more";
}

std::string why_no_drive(bool exists, const JointDrive& drive) {
  if (!exists) return "no such degree of freedom; check articulation, link and dof";
  if (const auto problem = problem_with(drive)) return *problem;
  return "a ball or a free joint has no position to be driven to; set the stiffness to 0, the "
         "damping drives its velocity";
}

}  // namespace vp
