// A scene as plain data that any engine can be given: what is there, how it is joined, what happens
// when. SI units, right-handed frames, z up.
//
// A dynamic body's origin is its centre of mass and its axes are principal axes of inertia, so that
// engines that know nothing else can take it as it is.
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

// A convex polyhedron. Bodies may share its data.
struct Polyhedron {
  struct Face {
    Vec3 normal;               // unit, outward
    double offset;             // of its plane along the normal [m]
    std::vector<int> corners;  // counter-clockwise seen from outside
  };
  std::vector<Vec3> points;  // corners only
  std::vector<Face> faces;
};
struct Hull {
  std::shared_ptr<const Polyhedron> data;
};
// The convex hull of points. Those that are within 1e-9 of the extent of a face's plane are on the
// face; those that are no corners are left out. Precondition: at most 256, not all in one plane.
Hull hull_of(std::vector<Vec3> points);

// Triangles, solid behind: the corners run counter-clockwise seen from outside; of fixed bodies
// only. Bodies may share its data.
struct Triangles {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> corners;  // indices of vertices
};
struct Mesh {
  std::shared_ptr<const Triangles> data;
};

using Shape = std::variant<Sphere, Box, Capsule, Ground, Terrain, Hull, Mesh>;

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
  // It exists from one time until another, and its joints while both of their bodies do [s].
  double from = 0.0, until = std::numeric_limits<double>::infinity();
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

// A body that exists is given another velocity.
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

// What happens while a scene runs, beside its motion: what exists at time 0 is no event.
struct Event {
  enum class Kind : std::uint8_t { remove_joint, remove_body, add_body, add_joint, launch };
  double time;  // [s]
  Kind kind;
  int index;  // of joints, bodies or launches
};
// In the order in which they happen: by time, then by kind, then by index. An event happens before
// the first step whose middle is not before its time.
std::vector<Event> events_of(const Scene& scene);
inline bool exists(const Body& body, double time) {
  return body.from <= time && time < body.until;
}
bool exists(const Scene& scene, const Joint& joint, double time);

// Whether any body has such a shape; what knows no height fields cannot have the scene.
bool has_terrain(const Scene& scene);

// Of the parts together; precondition: the body is dynamic.
struct Mass {
  double mass;   // [kg]
  Vec3 moments;  // about the origin, along the body's axes [kg m^2]
};
Mass mass_of(const Body& body);
// About its own centre of mass, along the axes of its frame; of what only fixed bodies have: zero.
Mass mass_of(const Shape& shape, double density);
// Turns a body whose parts lie anywhere into one that keeps the rule above: moves its origin to the
// centre of mass and its axes to principal ones. In the world the parts stay where they are; the
// hulls among them get new points where their frame is the body's.
void make_principal(Body& body);

}  // namespace scenes
