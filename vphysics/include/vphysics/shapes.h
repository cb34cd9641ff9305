// Shapes and what is attached to them. Lengths in metres, in the shape's own frame. Sizes are from
// 1e-6 to 1e9 m; what takes a shape refuses others.
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

// Segment of length 2 * half_length along z, swept by a sphere.
struct Capsule {
  double radius;
  double half_length;  // 0 or more, to 1e9
};

// The half-space z <= 0: solid below, surface normal +z. Only for colliders of fixed bodies.
struct HalfSpace {};

// Of length 2 * half_length along z.
struct Cylinder {
  double radius;
  double half_length;
};

// Along z: the base, a disc, at z = -half_height, the apex at z = +half_height. The centre of mass
// is half a half_height below the origin.
struct Cone {
  double radius;  // of the base
  double half_height;
};

// ConvexHull: vphysics/convex_hull.h. Only for colliders of fixed bodies, like the half-space:
// TriangleMesh, vphysics/triangle_mesh.h, and HeightField, vphysics/height_field.h. Several shapes
// as one: Compound, vphysics/compound.h.
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
  // Of that against spin about the normal [m]; the same. What lies on a single point spins on for
  // ever without it, and never sleeps.
  double spinning_friction = 0.0;
};

// Two colliders meet if each one's category is in the other's mask.
struct CollisionFilter {
  std::uint32_t category = 1;
  std::uint32_t mask = ~0u;
};

struct ColliderDesc {
  Shape shape = Sphere{1.0};
  SE3 T_body_shape;  // pose of the shape in the body's frame
  Material material;
  CollisionFilter filter;
  // Reports overlap as events, is never pushed; two sensors do not see one another, nor does
  // one on a fixed body see fixed bodies. Spheres of continuous bodies are seen at any speed, all
  // else where it is at the start of a step.
  bool sensor = false;
  std::uint64_t user_data = 0;  // returned in events and queries
  // How the surface runs past its own shape, as a conveyor belt's does; friction drags along what
  // touches it. Shape's frame [m/s].
  Vec3 surface_velocity;
  double density = 1000.0;  // [kg/m^3], > 0
};

// Inertia of a solid of uniform density [kg/m^3], about the shape's own origin, in the shape's
// frame. HalfSpace and HeightField have none, nor has a TriangleMesh without an inside: zero.
Inertia solid_inertia(const Shape& shape, double density);

// The shape stretched along the axes of its own frame, each factor in [1e-6, 1e6]. Refused: factors
// that turn the shape into another kind, as unequal ones do with a sphere or a capsule and unequal
// x and y with a cylinder or a cone; make a convex hull of it for these.
[[nodiscard]] Expected<Shape> scaled(const Shape& shape, const Vec3& scale);

}  // namespace vp
