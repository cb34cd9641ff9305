// A scene as plain data for any engine: its bodies, its joints, and its events. SI units,
// right-handed frames, z up.
//
// A dynamic body's origin is its centre of mass, and its axes are principal axes of inertia.
// Engines that support nothing else can therefore use it unchanged.
#pragma once

#include <array>
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
// The half-space z <= 0 of its frame; for fixed bodies only.
struct Ground {};
// A height field: sample (i, j) is at (i spacing, j spacing, height). Each cell is split along the
// diagonal from (i, j) to (i + 1, j + 1). Solid below; for fixed bodies only.
struct Terrain {
  int columns = 2, rows = 2;                           // number of samples along x and y
  double spacing = 1.0;                                // [m]
  std::shared_ptr<const std::vector<double>> heights;  // sample (i, j) at [j columns + i] [m]

  struct Below {
    double height;  // of the ground under a point [m]
    Vec3 normal;    // unit vector, upwards
  };
  // The ground under (x, y) of its frame; outside the grid, under the nearest point of the grid.
  Below below(double x, double y) const;
};

// A convex polyhedron. Bodies may share its data.
struct Polyhedron {
  struct Face {
    Vec3 normal;               // unit, outward
    double offset;             // of its plane along the normal [m]
    std::vector<int> corners;  // counter-clockwise, seen from outside
  };
  std::vector<Vec3> points;  // corners only
  std::vector<Face> faces;
};
struct Hull {
  std::shared_ptr<const Polyhedron> data;
};
// The convex hull of points. Points within 1e-9 of the extent from a face's plane are on the face.
// Points that are not corners are left out. Precondition: at most 256 points, not all in one plane.
Hull hull_of(std::vector<Vec3> points);

// A triangle mesh, solid behind: corners are counter-clockwise, seen from outside. For fixed bodies
// only. Bodies may share its data.
struct Triangles {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> corners;  // vertex indices
};
struct Mesh {
  std::shared_ptr<const Triangles> data;
};

using Shape = std::variant<Sphere, Box, Capsule, Ground, Terrain, Hull, Mesh>;

struct Material {
  double friction = 0.6;          // of a pair of two such surfaces
  double restitution = 0.0;       // a pair takes the larger of the two
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
  bool fast = false;  // small and fast: enable CCD in engines that have it
  // Engines with compounds take the parts, all of one material, as one shape.
  bool as_one = false;
  // The body exists from one time until another [s]. Its joints exist while both of their bodies
  // do.
  double from = 0.0, until = std::numeric_limits<double>::infinity();
};

// Connects two bodies, which do not collide with each other. Its frame is given in both bodies.
struct Joint {
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  enum class Kind : std::uint8_t {
    ball,   // the origins of both frames coincide
    hinge,  // their z axes, too
  };
  Kind kind;
  int a, b;  // indices of Scene::bodies
  SE3 T_a_joint, T_b_joint;
  double lower = -kNever, upper = kNever;  // limits of a hinge's angle, from a to b [rad]
};

// Sets the velocity of a body that exists.
struct Launch {
  double time;  // [s]
  int body;
  Vec3 velocity, spin;  // world frame [m/s], [rad/s]
};

// The condition for a dynamic body to count as in place at the end.
struct InPlace {
  enum class Rule : std::uint8_t {
    near_start,  // at most `distance` from its start
    inside,      // its origin is between lower and upper: it has not fallen through floor or walls
  };
  Rule rule = Rule::inside;
  double distance = 0.1;  // [m]
  Vec3 lower{-1e9, -1e9, -1.0}, upper{1e9, 1e9, 1e9};
};

struct Scene {
  std::string name;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Launch> launches;  // sorted by time
  Vec3 gravity{0.0, 0.0, -9.81};
  double seconds = 10.0;
  InPlace in_place;
};

// A change while a scene runs. Objects that exist at time 0 have no event.
struct Event {
  enum class Kind : std::uint8_t { remove_joint, remove_body, add_body, add_joint, launch };
  double time;  // [s]
  Kind kind;
  int index;  // of a joint, body or launch
};
// The scene's events in the order in which they happen: by time, then by kind, then by index. An
// event happens before the first step whose middle is not before its time.
std::vector<Event> events_of(const Scene& scene);
inline bool exists(const Body& body, double time) {
  return body.from <= time && time < body.until;
}
bool exists(const Scene& scene, const Joint& joint, double time);

// Whether any body has a Terrain. Engines without height fields cannot run the scene.
bool has_terrain(const Scene& scene);

// Mass properties of all parts together. Precondition: the body is dynamic.
struct Mass {
  double mass;   // [kg]
  Vec3 moments;  // about the origin, along the body's axes [kg m^2]
};
Mass mass_of(const Body& body);
// Moments about the shape's centre of mass, along the axes of its frame; zero for shapes of fixed
// bodies only.
Mass mass_of(const Shape& shape, double density);
// Moves the origin of a body with arbitrary parts to its centre of mass and its axes to principal
// axes, as the head comment requires. The parts keep their places in the world. Hulls whose frame
// is the body's get new points.
void make_principal(Body& body);

}  // namespace scenes
