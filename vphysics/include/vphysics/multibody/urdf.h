// Models from URDF, the Unified Robot Description Format 1.0 (wiki.ros.org/urdf/XML).
//
// A separate library, VirtualPhysics::urdf, which needs urdfdom and tinyxml2; the engine itself
// needs neither. Units are those of URDF: metres, kilograms, radians, seconds. The library prints
// nothing, throws nothing, and parses numbers independently of the locale. Any number of threads
// may load at once.
//
//   fixed                  FixedJoint
//   revolute, continuous   RevoluteJoint about the axis
//   prismatic              PrismaticJoint along the axis
//   floating               FreeJoint
//   planar                 PlanarJoint in the plane normal to the axis. An axis other than z adds
//                          an unnamed link before the joint's own link, as the frame of the plane
//
// Features without an equivalent in a model are listed in `notes`: visual geometry, materials,
// transmissions and other extensions are omitted. A joint that mimics another keeps its own
// coordinate, and UrdfJoint describes the relation. Collision geometry is described; mesh files are
// named but not read. vphysics/urdf_world.h adds a robot with its geometry to a World.
//
// Common errors in robot files are repaired and listed in `notes` with their line:
//   non-physical inertia                  accepted as given; a negative principal moment becomes
//                                         zero
//   a joint that moves no mass            an armature of a millionth of the robot's mass (times the
//                                         square of its length)
//   lower limit above the upper limit     exchanged
//   missing <limit>, effort or velocity,  no bound
//   or a negative one
//   negative damping or friction          zero
//   missing products of inertia           zero
//   an <axis> without xyz                 x; not read for a fixed or floating joint
//   a duplicate element                   the first is used
//   a <collision> without geometry or     omitted
//   with invalid numbers
//   a mimic that is circular, has no      omitted
//   target joint, or does not connect
//   two single coordinates
//   a robot without a name, zero bytes at the end of the file
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
  fixed,     // the root link is fixed to the world
  floating,  // the root link is free: a FreeJoint comes first
};

struct UrdfOptions {
  UrdfBase base = UrdfBase::fixed;
  // The root link's pose in the world; for a floating base, at zero coordinates.
  SE3 T_world_root{};
};

// A joint's properties in the file besides its type and pose. Units: [m] and [N] for a prismatic
// joint, [rad] and [N m] for a rotating one.
struct UrdfJoint {
  std::string name{};
  // The joint's link: Model::first_coordinate(link) is the index of its first coordinate in q. For
  // a planar joint whose axis is not z, the added link of the plane's frame.
  int link = 0;
  double lower = -std::numeric_limits<double>::infinity();  // of its coordinate
  double upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity();  // max speed, either sign
  double effort = std::numeric_limits<double>::infinity();    // max motor force, either sign
  double friction = 0.0;                                      // Coulomb friction
  // If not empty, the name of the joint to mimic: q = multiplier * q of that joint + offset.
  std::string mimics{};
  double multiplier = 1.0, offset = 0.0;
};

// One <collision> shape of a link. Lengths in metres, as in the file: sizes may be zero or
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
  Vec3 size{};          // box: edge lengths; mesh: scale factors of the axes
  double radius = 0.0;  // sphere, cylinder, capsule
  double length = 0.0;  // cylinder; capsule: without its caps
  std::string mesh{};   // as in the file: a path, package://NAME/..., model://, file://
};

struct UrdfModel {
  std::string name{};  // the robot's
  Model model;         // links in the order of the joints in the file, parents before children
  std::vector<UrdfJoint> joints{};  // the joints of the file, in the order of the links
  // One for each mimic joint, for a ConstraintSet. Both joints have one coordinate.
  std::vector<ConstraintPtr> couplings{};
  std::vector<UrdfCollision> collisions{};  // in the order of the links
  std::vector<std::string> notes{};         // what was omitted or repaired, with its line

  // The joint with this name, or null; valid as long as `joints`.
  const UrdfJoint* find_joint(std::string_view joint_name) const;
};

// Reads a robot from the text of a file. An error's message begins with the line: "line 12: ...".
// Errc::bad_data: text that is not well-formed XML (or nested more than 100 deep) or not a <robot>;
// a missing element or attribute that has no default; a value that is not a finite number; a joint
// of unknown type, with two parents or children, or moving along an axis of zero length; an unknown
// or duplicate name; links that do not form a single tree; a negative mass; no joint that moves
// (with a fixed base). Errc::unsupported: more than 16 MiB of text. Errc::invalid_argument:
// T_world_root is not a valid pose.
Expected<UrdfModel> parse_urdf(std::string_view text, const UrdfOptions& options = {});

// Reads a robot from a file. Errc::bad_data also if the file cannot be read. The message begins
// with the path.
Expected<UrdfModel> load_urdf(const std::string& path, const UrdfOptions& options = {});

}  // namespace vp
