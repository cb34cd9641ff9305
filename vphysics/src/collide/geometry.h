// Shapes in the engine's internal form: flat, without a variant.
#pragma once

#include <cstdint>

#include "collide/hull.h"
#include "vphysics/shapes.h"

namespace vp::collide {

// The last three are made of parts: they have no signed distance and no single manifold.
enum class Kind : std::uint8_t {
  sphere,
  capsule,
  box,
  cylinder,
  cone,
  hull,
  triangle,  // of a mesh or a height field, or a single sheet
  half_space,
  mesh,
  height_field,
  compound,
};

class Surface;
struct CompoundData;

struct Geometry {
  Kind kind = Kind::sphere;
  double radius = 0.0;  // sphere, capsule, cylinder; of a cone's base
  // Box: half extents; capsule, cylinder, cone: (0, 0, half length); mesh, height field: scale.
  Vec3 half;
  // Owned by the shape's owner.
  union {
    const HullData* hull = nullptr;
    const Vec3* corners;  // of a triangle: three, counter-clockwise seen from the front
    const MeshData* mesh;
    const HeightData* field;
    const CompoundData* compound;
  };
};

// Precondition: the shape outlives the geometry.
Geometry make_geometry(const Shape& shape);
Geometry triangle_geometry(const Vec3 corners[3]);

inline bool is_surface(const Geometry& g) {
  return g.kind == Kind::mesh || g.kind == Kind::height_field;
}
// Bounded and convex.
inline bool is_convex_body(const Geometry& g) {
  return g.kind < Kind::triangle;
}
Surface surface_of(const Geometry& g);  // precondition: is_surface(g)

// The signed distance of a point in the shape's frame from its surface, negative inside, and its
// gradient. The shapes are convex, hence so is the distance: it is above each of its tangent
// planes. The sweep depends on this.
struct SignedDistance {
  double distance;
  Vec3 normal;  // unit, outward
};
SignedDistance signed_distance(const Geometry& geometry, const Vec3& point);

}  // namespace vp::collide
