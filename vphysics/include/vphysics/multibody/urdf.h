// Models from URDF, the Unified Robot Description Format 1.0 (wiki.ros.org/urdf/XML).
//
// Of a library of its own, VirtualPhysics::urdf, which needs urdfdom and tinyxml2; the engine
// itself needs neither. Units are URDF's: metres, kilograms, radians, seconds. Nothing is printed,
// nothing is thrown, and numbers read the same in every locale. Any number of threads may read at
// once.
//
//   fixed                  FixedJoint
//   revolute, continuous   RevoluteJoint about the axis
//   prismatic              PrismaticJoint along the axis
//   floating               FreeJoint
//   planar                 PlanarJoint in the plane across the axis. An axis other than z needs a
//                          link more, without a name and before the joint's own, as the plane's
//                          frame
//
// What a model has no place for is told in notes: visual geometry, materials, transmissions and
// other extensions are left out; a joint that mimics another keeps a coordinate of its own, and
// UrdfJoint says what it shall follow. Collision geometry is described, and meshes are named, not
// read: vphysics/urdf_world.h puts a robot with its geometry into a World.
//
// What robots' files have wrong is mended, and told in notes by its line:
//   an inertia that no body has           taken as stated; a negative principal moment is zero
//   a joint that moves no mass            an armature of a millionth of the robot's mass (times the
//                                         square of its length)
//   a lower limit above the upper one     the two exchanged
//   no <limit>, effort or velocity, or    no bound
//   a negative one
//   negative damping or friction          zero
//   products of inertia not given         zero
//   an <axis> without xyz                 x; of a fixed or floating joint it is never read
//   an element twice                      the first
//   a <collision> without geometry or     left out
//   with numbers that are none
//   a mimic that leads in a circle, to    left out
//   no joint, or not from one coordinate
//   to one
//   a robot without a name, zero bytes at its end
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "vphysics/multibody/constraint.h"
#include "vphysics/multibody/model.h"

namespace vp {

enum class UrdfBase {
  fixed,     // the root link stands in the world
  floating,  // it is free: a FreeJoint comes first
};

struct UrdfOptions {
  UrdfBase base = UrdfBase::fixed;
  // The root link's pose in the world; of a floating base, at zero coordinates.
  SE3 T_world_root{};
};

// What the file says of a joint beside its kind and place. Units: [m] and [N] of a prismatic joint,
// [rad] and [N m] of one that turns.
struct UrdfJoint {
  std::string name{};
  // Whose joint it is: Model::first_coordinate(link) is its first of q. The link that it carries,
  // or that of the plane before it.
  int link = 0;
  double lower = -std::numeric_limits<double>::infinity();  // of its coordinate
  double upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity();  // largest, either way, a second
  double effort = std::numeric_limits<double>::infinity();    // largest of its motor, either way
  double friction = 0.0;                                      // Coulomb friction
  // If not empty, a joint that it shall follow: q = multiplier * q of that joint + offset.
  std::string mimics{};
  double multiplier = 1.0, offset = 0.0;
};

// A <collision> of a link: one shape. Lengths in metres, as the file has them: sizes may be zero or
// negative.
struct UrdfCollision {
  enum class Kind : std::uint8_t {
    box,
    sphere,
    cylinder,  // along z
    capsule,   // along z; an extension of the format
    mesh,
  };
  std::string name{};  // may be empty
  int line = 0;        // of the file
  int link = 0;
  SE3 T_link_shape{};
  Kind kind = Kind::box;
  Vec3 size{};  // of a box, its edges; of a mesh, the factors that its axes are stretched by
  double radius = 0.0;  // of a sphere, a cylinder, a capsule
  double length = 0.0;  // of a cylinder; of a capsule without its caps
  std::string mesh{};   // as the file names it: a path, package://NAME/..., model://, file://
};

struct UrdfModel {
  std::string name{};  // the robot's
  Model model;         // links in the order of the joints in the file, parents before children
  std::vector<UrdfJoint> joints{};  // of the file, in the order of the links
  // One for each joint that mimics another: for a ConstraintSet. Both have one coordinate.
  std::vector<ConstraintPtr> couplings{};
  std::vector<UrdfCollision> collisions{};  // in the order of the links
  std::vector<std::string> notes{};         // what was left out or mended, with its line

  // The joint of this name, or null; valid as long as the joints are.
  const UrdfJoint* find_joint(std::string_view joint_name) const;
};

// Reads a robot from the text of a file. An error's message begins with the line: "line 12: ...".
// Errc::bad_data: not well-formed XML (also nested more than 100 deep), not a <robot>, an element
// or attribute missing that has no default, a value that is no finite number, a joint of unknown
// type, with two parents or children, or that moves along an axis of length zero, a name that is
// unknown or taken, links that are no single tree, a negative mass, no joint that moves (with a
// fixed base). Errc::unsupported: more than 16 MiB of text. Errc::invalid_argument:
// T_world_root is no pose.
Expected<UrdfModel> parse_urdf(std::string_view text, const UrdfOptions& options = {});

// The same from a file; Errc::bad_data too where it cannot be read. The message begins with the
// path.
Expected<UrdfModel> load_urdf(const std::string& path, const UrdfOptions& options = {});

}  // namespace vp
