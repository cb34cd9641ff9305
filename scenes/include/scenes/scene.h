// A scene as plain data that any engine can be given: what is there, how it is joined, what happens
// when. SI units, right-handed frames, z up.
//
// A dynamic body's origin is its centre of mass and its axes are principal axes of inertia, so that
// engines that know nothing else can take it as it is.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "vphysics/lie.h"

namespace scenes {

using vp::SE3;
using vp::Vec3;

struct Sphere {
  double radius;  // [m]
};
struct Box {
  Vec3 half_extents;  // [m]
};
// A segment of length 2 * half_length along z, swept by a sphere.
struct Capsule {
  double radius, half_length;  // [m]
};
// The half-space z <= 0 of its own frame; of fixed bodies only.
struct Ground {};
// Ground by its height over a grid: sample (i, j) at (i spacing, j spacing, height), each cell cut
// along the diagonal from (i, j) to (i + 1, j + 1), solid below; of fixed bodies only.
struct Terrain {
  int columns = 2, rows = 2;                           // of samples, along x and y
  double spacing = 1.0;                                // [m]
  std::shared_ptr<const std::vector<double>> heights;  // of sample (i, j) at [j columns + i] [m]

  struct Below {
    double height;  // of the ground under a point [m]
    Vec3 normal;    // unit, upwards
  };
  // Under (x, y) of its frame, or under the nearest point that has ground.
  Below below(double x, double y) const;
};

using Shape = std::variant<Sphere, Box, Capsule, Ground, Terrain>;

struct Material {
  double friction = 0.6;          // of a pair of two such surfaces
  double restitution = 0.0;       // of a pair: the larger of the two
  double rolling_friction = 0.0;  // lever arm [m]
};

struct Part {
  Shape shape;
  SE3 T_body_shape;
  double density = 1000.0;  // [kg/m^3]
  Material material;
};

enum class Motion : std::uint8_t { fixed, kinematic, dynamic };

struct Body {
  Motion motion = Motion::dynamic;
  SE3 T_world_body;
  Vec3 velocity, spin;  // of the origin, world frame [m/s], [rad/s]
  std::vector<Part> parts;
  bool fast = false;  // small and fast: an engine that can sweep bodies sweeps it
  // An engine that has compounds takes the parts, which are of one material, as one shape.
  bool as_one = false;
};

// Holds two bodies together; these two do not meet. Its frame is given in both bodies.
struct Joint {
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  enum class Kind : std::uint8_t {
    ball,   // the two frames' origins stay together
    hinge,  // and so do their z axes
  };
  Kind kind;
  int a, b;  // into Scene::bodies
  SE3 T_a_joint, T_b_joint;
  double lower = -kNever, upper = kNever;  // of a hinge's angle, from a to b [rad]
};

// A body is given another velocity.
struct Launch {
  double time;  // [s]
  int body;
  Vec3 velocity, spin;  // world frame
};

// What a dynamic body must be to count as in place at the end.
struct InPlace {
  enum class Rule : std::uint8_t {
    near_start,  // no farther than distance from where it was
    inside,      // its origin between lower and upper: nothing has fallen through floor and walls
  };
  Rule rule = Rule::inside;
  double distance = 0.1;  // [m]
  Vec3 lower{-1e9, -1e9, -1.0}, upper{1e9, 1e9, 1e9};
};

struct Scene {
  std::string name;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Launch> launches;  // in the order of time
  Vec3 gravity{0.0, 0.0, -9.81};
  double seconds = 10.0;
  InPlace in_place;
};

// Whether any body has such a shape; what knows no height fields cannot have the scene.
bool has_terrain(const Scene& scene);

// Of the parts together; precondition: the body is dynamic.
struct Mass {
  double mass;   // [kg]
  Vec3 moments;  // about the origin, along the body's axes [kg m^2]
};
Mass mass_of(const Body& body);
// About its own centre; of Ground and Terrain: zero.
Mass mass_of(const Shape& shape, double density);

}  // namespace scenes
