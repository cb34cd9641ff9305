// Joints between two bodies of a world, and user-defined constraints between them.
//
// A joint has a frame on each of its bodies, T_a_joint and T_b_joint. The pose of b's frame in a's
// frame gives its coordinates:
//
//   x, y, z                 b's origin along the axes of a's frame [m]
//   rotation_x, rotation_y  the shortest rotation that takes a's z axis to b's, as a vector
//                           perpendicular to a's z [rad]; its angle is less than pi; do not use it
//                           near pi
//   rotation_z              the remaining rotation about z [rad]; counts full revolutions
//
// One of the two bodies may be fixed or kinematic. Each may be a link; two links of one
// articulation close a kinematic loop. A continuous body may be joined to another continuous body,
// to a link, and to a fixed or kinematic body. It is an error to join it to a dynamic body that is
// not continuous, whose contacts are solved at other times.
//
// Joints between bodies in sub-steps are solved in every sub-step, before the contacts, and are as
// stiff as the sub-step allows. Joints of links and of continuous bodies are solved together with
// the contacts of these, exactly if the coupled rows are few: a loop stays closed at impacts too.
// There, springs and drives act once a step.
//
// Source: Catto, Soft Constraints, GDC 2011, for springs and soft constraints; docs/decisions/0023.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "vphysics/lie.h"

namespace vp {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// A motor: force = clamp(stiffness (position - q) + damping (velocity - v), +-max_force),
// integrated implicitly, so that it is stable at any stiffness. Between bodies a drive is at most
// as stiff as a locked axis: stiffness h^2 = 4 m, where h is the sub-step and m the mass that it
// moves (of a rotation, the moment of inertia); a larger stiffness and its damping act reduced to
// that. For a velocity motor, set the stiffness to 0 and a damping so large that max_force limits
// the force. Units: of a translation | of a rotation. For a ball or a free joint of an articulation
// it drives one of the velocities, and stiffness must be 0.
struct JointDrive {
  double position = 0.0;   // [m] | [rad]
  double velocity = 0.0;   // [m/s] | [rad/s]
  double stiffness = 0.0;  // [N/m] | [N m/rad]; max 1e15, as for damping
  double damping = 0.0;    // [N s/m] | [N m s/rad]
  double max_force = 0.0;  // [N] | [N m]; 0: no motor
  bool operator==(const JointDrive&) const = default;
};

// The origins coincide.
struct BallSocket {};

// The origins and the z axes coincide. Its coordinate is rotation_z. Limits may be any number of
// revolutions away.
struct Hinge {
  double lower = -kNoLimit, upper = kNoLimit;  // [rad]
  JointDrive drive;
};

// b translates along a's z without rotation. Its coordinate is z.
struct Slider {
  double lower = -kNoLimit, upper = kNoLimit;  // [m]
  JointDrive drive;
};

// The frames coincide.
struct Weld {};

// The distance of the origins is between min and max. If both are equal, it is a rigid rod. Its
// coordinate is the distance [m].
struct Distance {
  double min = 0.0, max = 0.0;
};

// A spring and damper between the origins, in tension and compression. Its coordinate is the length
// [m]. The integration adds or removes no energy up to stiffness h^2 = m / 4, where h is the
// sub-step; stiffer springs lose some.
struct Spring {
  double length = 0.0;     // rest length [m]
  double stiffness = 0.0;  // [N/m]
  double damping = 0.0;    // [N s/m]
};

// The origins coincide, b's z axis stays within an elliptic cone about a's z, and rotation_z within
// limits. Its coordinate is rotation_z, the twist.
struct ConeTwist {
  // Max rotation_x and rotation_y; in (0, 3.1] [rad].
  double swing_x = 0.5, swing_y = 0.5;
  double lower = -kNoLimit, upper = kNoLimit;  // of the twist [rad]
  JointDrive drive;                            // of the twist
};

enum class AxisMotion : std::uint8_t { free, limited, locked };
enum class JointAxis : std::uint8_t { x, y, z, rotation_x, rotation_y, rotation_z };
struct AxisDesc {
  AxisMotion motion = AxisMotion::free;
  double lower = 0.0, upper = 0.0;  // if limited
  JointDrive drive;                 // unless locked
};
// Each coordinate separately, indexed by JointAxis. A locked coordinate stays at 0.
struct SixDof {
  AxisDesc axes[6];
};

// Couples the rotations of both bodies about their z axes, or their translations along them:
//   q_b = ratio q_a + constant.
// The bearings must not rotate: both z axes are assumed to be fixed in the world. Meshing wheels
// have ratio -r_a / r_b. A rack on a pinion of radius r has ratio +-r [m/rad]. Its coordinate is
// q_b - ratio q_a, initially 0.
struct Gear {
  double ratio = -1.0;
  bool slides_a = false, slides_b = false;
};

// One row of a Jacobian: residual' = <a, V_a> + <b, V_b>, with the bodies' generalized velocities
// in their own frames about their origins. RowJacobian numbers.
struct PairRow {
  dse3 a, b;
};

// Softness and force limits of a row.
struct ConstraintRowDesc {
  double frequency = 0.0;      // of the spring that pulls the residual to 0 [Hz]; 0: hard
  double damping_ratio = 1.0;  // of that spring
  // Limits of the row's force, dual to its residual. They define one-sided rows (0 to kNoLimit) or
  // slipping rows.
  double min_force = -kNoLimit, max_force = kNoLimit;
};

// A user-defined constraint: derive from it. Any number of joints, worlds and threads may use it.
class PairConstraint {
 public:
  virtual ~PairConstraint() = default;
  virtual int rows() const = 0;                       // 1 to 6, constant
  virtual ConstraintRowDesc row_desc(int row) const;  // called once, when the joint is created
  // Called several times a step; must not allocate. On entry all values are zero. A row of zeros
  // constrains nothing; linearly dependent rows are valid. Values that are not finite count as
  // zero.
  virtual void evaluate(const SE3& T_world_a, const SE3& T_world_b, std::span<double> residual,
                        std::span<PairRow> jacobian) const = 0;
  // All constants of the constraint. They are part of the topology hash that restore() checks.
  virtual std::vector<double> constants() const { return {}; }
};

struct UserConstraint {
  std::shared_ptr<const PairConstraint> constraint;
};

using JointKind = std::variant<BallSocket, Hinge, Slider, Weld, Distance, Spring, ConeTwist, SixDof,
                               Gear, UserConstraint>;

struct JointDesc {
  JointKind kind;
  SE3 T_a_joint, T_b_joint;  // not of a UserConstraint
  bool collide = false;      // whether a and b may collide
  // Softness of locked coordinates and of limits: a spring of this frequency [Hz] against the
  // masses of the two bodies alone, with its damping ratio. 0: hard.
  double frequency = 0.0;
  double damping_ratio = 1.0;
};

// The mean force of the joint on b in the last step; on a it is the opposite.
struct JointForce {
  Vec3 force;  // world frame [N]
  // About the origin of b's joint frame (of a UserConstraint: b's centre of mass, or a link's
  // origin), world frame [N m].
  Vec3 torque;
};

}  // namespace vp
