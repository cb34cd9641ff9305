// Joints between a link and its parent.
//
// LinkSpec::T_parent_joint places the joint's frame in the parent's link frame. At zero coordinates
// the link's frame coincides with it. A joint maps its coordinates q to the pose of the link in the
// joint's frame, and its velocities v to the link's twist relative to the parent, S(q) v, in the
// link's frame. For all joints except ball and free, v is the rate of q.
//
// Units: metres along an axis, radians about it. An axis need not have unit length. Source: paper,
// appendix A, M_i e^(S_i q_i).
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <variant>

#include "vphysics/lie.h"

namespace vp {

struct FixedJoint {};  // no degrees of freedom: the link is merged into its parent
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
  Vec3 axis{0, 0, 1};  // q = (slide, angle) along and about the same axis
};
// Two revolute joints with intersecting axes: `first` is fixed in the parent, `second` in the link.
struct UniversalJoint {
  Vec3 first{1, 0, 0}, second{0, 1, 0};  // q = (angle, angle); not parallel
};
// Translates along x and y of the joint's frame, then rotates about z.
struct PlanarJoint {};  // q = (x, y, angle)
// q = unit quaternion (x, y, z, w) of the link in the joint's frame; v = angular velocity in the
// link's frame.
struct BallJoint {};
// q = position (x, y, z) and unit quaternion (x, y, z, w); v = (angular, linear) velocity in the
// link's frame.
struct FreeJoint {};

// A user-defined joint: up to six velocities, one coordinate for each. Evaluation must not
// allocate. All models and threads may share one object.
class UserJoint {
 public:
  virtual ~UserJoint() = default;
  virtual int degrees_of_freedom() const = 0;  // 1 to 6
  // At coordinates q and velocities v: the pose of the link in the joint's frame; the motion
  // subspace, one column S[k] for each coordinate, in the link's frame; and its rate times the
  // velocities, (dS/dt) v, in the link's frame. S must have full rank wherever the joint is used.
  virtual void evaluate(std::span<const double> q, std::span<const double> v, SE3& T_joint_link,
                        std::span<se3> S, se3& rate) const = 0;
  // The derivatives of the results of evaluate. Only derivatives of the dynamics and rates of
  // Jacobians need them. With n degrees of freedom: dS[k]/dq[l] in dS_dq[n * k + l], and d
  // rate/dq[l] at constant v in drate_dq[l], in the link's frame. The default returns false: not
  // available. Calls that need them then return an error.
  virtual bool subspace_derivatives(std::span<const double> /*q*/, std::span<const double> /*v*/,
                                    std::span<se3> /*dS_dq*/, std::span<se3> /*drate_dq*/) const {
    return false;
  }
};

using Joint = std::variant<FixedJoint, RevoluteJoint, PrismaticJoint, HelicalJoint,
                           CylindricalJoint, UniversalJoint, PlanarJoint, BallJoint, FreeJoint,
                           std::shared_ptr<const UserJoint>>;

// The forces in one of a joint's velocities besides armature and viscous damping: forces and metres
// for translation, moments and radians for rotation. joint_forces.h and constrained_step.h apply
// them.
struct JointForces {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // The coordinate's limits. A limit with infinite stiffness is a stop: rigid, without restitution.
  // A softer limit acts as a spring and damper while the coordinate is beyond it.
  double lower = -kNever, upper = kNever;
  double limit_stiffness = kNever;  // [N/m], [N m/rad]
  double limit_damping = 0.0;       // [N s/m], [N m s/rad]; unused for a stop
  // A spring with its rest position at the coordinate `rest`.
  double stiffness = 0.0, rest = 0.0;
  // Coulomb friction: the maximum resisting force, which acts while the joint slides [N], [N m].
  // Infinite: the joint is locked.
  double friction = 0.0;
  // The maximum force of a motor, whatever its targets [N], [N m].
  double motor_limit = kNever;
};

// The number of a joint's coordinates and of its velocities.
int coordinates_of(const Joint& joint);
int velocities_of(const Joint& joint);

}  // namespace vp
