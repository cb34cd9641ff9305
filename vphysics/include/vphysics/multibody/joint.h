// Joints between a link and its parent.
//
// The joint's frame is placed in the parent's link frame (LinkSpec::T_parent_joint); at zero
// coordinates the link's frame coincides with it. A joint maps its coordinates q to the pose of the
// link in the joint's frame, and its velocities v to the link's generalized velocity relative to
// the parent, S(q) v, in the link's frame. For all joints but ball and free, v is the rate of q.
//
// Units: metres along, radians around an axis; an axis need not be of unit length.
// Source: paper, appendix A, M_i e^(S_i q_i).
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <variant>

#include "vphysics/lie.h"

namespace vp {

struct FixedJoint {};  // no freedom: the link becomes a part of its parent
struct RevoluteJoint {
  Vec3 axis{0, 0, 1};  // q = (angle)
};
struct PrismaticJoint {
  Vec3 axis{0, 0, 1};  // q = (slide)
};
struct HelicalJoint {
  Vec3 axis{0, 0, 1};  // q = (angle)
  double pitch = 0.0;  // [m/rad] along the axis
};
struct CylindricalJoint {
  Vec3 axis{0, 0, 1};  // q = (slide, angle) along and around the same axis
};
// Two revolute joints through one point: first turns with the parent, second with the link.
struct UniversalJoint {
  Vec3 first{1, 0, 0}, second{0, 1, 0};  // q = (angle, angle); not parallel
};
// Slides along x and y of the joint's frame, then turns about its z.
struct PlanarJoint {};  // q = (x, y, angle)
// q = unit quaternion (x, y, z, w) of the link in the joint's frame; v = angular velocity in the
// link's frame.
struct BallJoint {};
// q = position (x, y, z) and unit quaternion (x, y, z, w); v = (angular, linear) velocity in the
// link's frame.
struct FreeJoint {};

// A joint of one's own: up to six velocities, one coordinate for each. It is evaluated without
// allocating, and is the same object for all models and threads that use it.
class UserJoint {
 public:
  virtual ~UserJoint() = default;
  virtual int degrees_of_freedom() const = 0;  // 1 to 6
  // At coordinates q and rates v: the pose of the link in the joint's frame; the motion subspace,
  // one column S[k] for each coordinate, in the link's frame; and its rate times the velocities,
  // (dS/dt) v, in the link's frame. S must have full rank wherever the joint is used.
  virtual void evaluate(std::span<const double> q, std::span<const double> v, SE3& T_joint_link,
                        std::span<se3> S, se3& rate) const = 0;
  // For derivatives of the dynamics and rates of Jacobians, if they are wanted of a model with this
  // joint: the slopes of what evaluate gives. With n degrees, dS[k]/dq[l] in dS_dq[n * k + l], and
  // d rate/dq[l] at fixed v in drate_dq[l], in the link's frame. A joint that does not have them
  // returns false, as here; calls that need them then say so.
  virtual bool subspace_derivatives(std::span<const double> /*q*/, std::span<const double> /*v*/,
                                    std::span<se3> /*dS_dq*/, std::span<se3> /*drate_dq*/) const {
    return false;
  }
};

using Joint = std::variant<FixedJoint, RevoluteJoint, PrismaticJoint, HelicalJoint,
                           CylindricalJoint, UniversalJoint, PlanarJoint, BallJoint, FreeJoint,
                           std::shared_ptr<const UserJoint>>;

// What acts in one of a joint's velocities besides armature and viscous damping: forces and metres
// of a slide, moments and radians of a turn. joint_forces.h and constrained_step.h apply them.
struct JointForces {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // The coordinate's limits. A limit of infinite stiffness is a stop: rigid, and nothing bounces
  // off it. A softer one pushes back by stiffness and damping where the coordinate is beyond it.
  double lower = -kNever, upper = kNever;
  double limit_stiffness = kNever;  // [N/m], [N m/rad]
  double limit_damping = 0.0;       // [N s/m], [N m s/rad]; none for a stop
  // A spring, at rest at the coordinate `rest`.
  double stiffness = 0.0, rest = 0.0;
  // Coulomb's: what the joint resists with at most, and where it slides [N], [N m]. Infinite: the
  // joint is locked.
  double friction = 0.0;
  // What a motor can do at most, whatever it is told [N], [N m].
  double motor_limit = kNever;
};

// How many numbers a joint's coordinates and velocities are.
int coordinates_of(const Joint& joint);
int velocities_of(const Joint& joint);

}  // namespace vp
