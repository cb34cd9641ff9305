// Shapes and their attachment to bodies. Lengths in metres, in the shape's frame. Sizes are from
// 1e-6 to 1e9 m; functions that take a shape reject others.
#pragma once

#include <cstdint>
#include <variant>

#include "vphysics/compound.h"
#include "vphysics/convex_hull.h"
#include "vphysics/error.h"
#include "vphysics/height_field.h"
#include "vphysics/lie.h"
#include "vphysics/triangle_mesh.h"

namespace vp {

struct Sphere {
  double radius;
};

struct Box {
  Vec3 half_extents;
};

// A segment of length 2 * half_length along z, swept by a sphere.
struct Capsule {
  double radius;
  double half_length;  // 0 or more, up to 1e9
};

// The half-space z <= 0: solid below, surface normal +z. Only for colliders of fixed bodies.
struct HalfSpace {};

// Length 2 * half_length along z.
struct Cylinder {
  double radius;
  double half_length;
};

// Along z: the base, a disc, at z = -half_height, the apex at z = +half_height. The centre of mass
// is half_height / 2 below the origin.
struct Cone {
  double radius;  // of the base
  double half_height;
};

// ConvexHull: vphysics/convex_hull.h. Compound, several shapes as one: vphysics/compound.h.
// TriangleMesh, vphysics/triangle_mesh.h, and HeightField, vphysics/height_field.h, are only for
// colliders of fixed and kinematic bodies.
using Shape = std::variant<Sphere, Box, Capsule, HalfSpace, Cylinder, Cone, ConvexHull,
                           TriangleMesh, HeightField, Compound>;

struct CompoundPart {
  Shape shape;
  SE3 T_compound_part;  // pose of the shape in the compound's frame
};

struct Material {
  double friction = 0.5;          // Coulomb; a pair uses sqrt(a * b)
  double restitution = 0.0;       // [0, 1]; a pair uses the larger
  double rolling_friction = 0.0;  // lever arm of the rolling resistance [m]; a pair uses the larger
  // Lever arm of the resistance to spin about the normal [m]; a pair uses the larger. At 0, a body
  // that rests on a single point spins forever and never sleeps.
  double spinning_friction = 0.0;
};

// Two colliders collide if the category of each is in the mask of the other.
struct CollisionFilter {
  std::uint32_t category = 1;
  std::uint32_t mask = ~0u;
};

struct ColliderDesc {
  Shape shape = Sphere{1.0};
  SE3 T_body_shape;  // pose of the shape in the body's frame
  Material material;
  CollisionFilter filter;
  // A sensor reports overlap as events and gets no impulses. Two sensors do not detect each other,
  // and a sensor on a fixed body does not detect fixed bodies. Spheres of continuous bodies are
  // detected at any speed (swept); all other colliders at their pose at the start of a step.
  bool sensor = false;
  std::uint64_t user_data = 0;  // returned in events and queries
  // Velocity of the surface relative to its own shape, as of a conveyor belt; friction acts towards
  // it. Shape's frame [m/s].
  Vec3 surface_velocity;
  double density = 1000.0;  // [kg/m^3], > 0
};

// Inertia of a solid of uniform density [kg/m^3], about the shape's origin, in the shape's frame.
// Zero for a HalfSpace, a HeightField, and a TriangleMesh that is not closed.
Inertia solid_inertia(const Shape& shape, double density);

// The shape scaled along the axes of its frame, each factor in [1e-6, 1e6]. Error: factors that do
// not preserve the kind of shape, such as unequal ones for a sphere or a capsule, and unequal x and
// y for a cylinder or a cone. Make a convex hull for these.
[[nodiscard]] Expected<Shape> scaled(const Shape& shape, const Vec3& scale);

}  // namespace vp
