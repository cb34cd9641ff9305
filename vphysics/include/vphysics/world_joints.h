// Joints between two bodies of a world, and constraints of one's own between them.
//
// A joint has a frame on each of its bodies, T_a_joint and T_b_joint. Where b's frame is seen from
// a's gives its coordinates:
//
//   x, y, z         b's origin along the axes of a's frame [m]
//   rotation_x, rotation_y  the shortest turn that takes a's z axis to b's, as a vector across a's
//   z [rad];
//                   each within half a turn, not to be used near it
//   rotation_z          the turn about z that is left [rad]; counted on beyond whole turns
//
// One of the two bodies may be fixed or kinematic, each may be a link: of one articulation they
// close a loop of its tree. A continuous body may be joined to another one, to a link and to what
// is fixed or kinematic; refused: to a dynamic body that is not continuous, whose contacts are
// solved at other times.
//
// Joints between free bodies are solved in every sub-step, before the contacts, and hold as stiffly
// as the sub-step allows. Those of links and of continuous bodies are solved with what touches
// these, exactly where together they are few: a loop stays closed at impacts too. Springs and
// drives are felt once a step there.
//
// Source: Catto, Soft Constraints, GDC 2011, for springs and the softness of what is held;
// docs/decisions/0023.
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
// integrated implicitly, so that any stiffness is stable. A motor of a velocity alone has no
// stiffness and a damping so large that max_force bounds it. Units: of a slide | of an angle. Of a
// ball or a free joint of an articulation it drives one of the velocities: stiffness must be 0.
struct JointDrive {
  double position = 0.0;   // [m] | [rad]
  double velocity = 0.0;   // [m/s] | [rad/s]
  double stiffness = 0.0;  // [N/m] | [N m/rad]; this and damping at most 1e15
  double damping = 0.0;    // [N s/m] | [N m s/rad]
  double max_force = 0.0;  // [N] | [N m]; 0: no motor
  bool operator==(const JointDrive&) const = default;
};

// The origins coincide.
struct BallSocket {};

// The origins and the z axes coincide. Its coordinate is rotation_z; limits may be any number of
// turns away.
struct Hinge {
  double lower = -kNoLimit, upper = kNoLimit;  // [rad]
  JointDrive drive;
};

// b moves along a's z and does not turn. Its coordinate is z.
struct Slider {
  double lower = -kNoLimit, upper = kNoLimit;  // [m]
  JointDrive drive;
};

// The frames coincide.
struct Weld {};

// The origins are between least and most apart; equal ones make a rod. Its coordinate is the
// distance [m].
struct Distance {
  double min = 0.0, max = 0.0;
};

// A spring with a damper between the origins; it pushes and pulls. Its coordinate is the length
// [m]. Neither spring nor damper takes or gives energy of itself up to stiffness h^2 = m / 4, with
// h the sub-step; stiffer springs lose some.
struct Spring {
  double length = 0.0;     // at rest [m]
  double stiffness = 0.0;  // [N/m]
  double damping = 0.0;    // [N s/m]
};

// The origins coincide, b's z axis stays within an elliptic cone about a's z, and rotation_z within
// limits. Its coordinate is rotation_z, the twist.
struct ConeTwist {
  double swing_x = 0.5, swing_y = 0.5;  // most of rotation_x, of rotation_y; in (0, 3.1] [rad]
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
// Each coordinate as one likes, by JointAxis. One that is locked is held at 0.
struct SixDof {
  AxisDesc axes[6];
};

// Couples how both bodies turn about their z axes, or slide along them: q_b = ratio q_a + constant.
// For axes whose bearings do not turn: both z axes are taken to stand still. Wheels that mesh have
// ratio -r_a / r_b; a rack that slides on a pinion of radius r has ratio +-r [m/rad]. Its
// coordinate is q_b - ratio q_a, 0 at first.
struct Gear {
  double ratio = -1.0;
  bool slides_a = false, slides_b = false;
};

// One row of a Jacobian: residual' = <a, V_a> + <b, V_b> with the bodies' generalized velocities in
// their own frames about their origins. Twelve numbers.
struct PairRow {
  dse3 a, b;
};

// What a row may do.
struct ConstraintRowDesc {
  double frequency = 0.0;      // of the spring that holds it at residual 0 [Hz]; 0: hard
  double damping_ratio = 1.0;  // of that spring
  // Of the row's force, dual to its residual: bounds that make one-sided (0 to kNoLimit) or
  // slipping rows.
  double min_force = -kNoLimit, max_force = kNoLimit;
};

// A constraint of one's own: derive from it, in one's own source file. It may be used by any number
// of joints, worlds and threads.
class PairConstraint {
 public:
  virtual ~PairConstraint() = default;
  virtual int rows() const = 0;                       // 1 to 6, the same always
  virtual ConstraintRowDesc row_desc(int row) const;  // asked once, when the joint is created
  // Called some times a step without allocating. All is zero at first. A row of zeros holds
  // nothing; rows that depend on others are fine. What is not finite counts as zero.
  virtual void evaluate(const SE3& T_world_a, const SE3& T_world_b, std::span<double> residual,
                        std::span<PairRow> jacobian) const = 0;
  // Enters the digest by which restore() knows a world again: all constants of the constraint.
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
  bool collide = false;      // whether a and b may meet
  // Softness of what is held, and of what stops at a limit: as a spring of this frequency against
  // the bodies alone [Hz], with its damping ratio. 0: hard.
  double frequency = 0.0;
  double damping_ratio = 1.0;
};

// What the joint did to b in the last step, on the average; to a the opposite.
struct JointForce {
  Vec3 force;   // world frame [N]
  Vec3 torque;  // about the origin of b's joint frame (of a UserConstraint: b's centre of mass,
                // or a link's origin), world frame [N m]
};

}  // namespace vp
