// Shapes as the engine keeps them: flat, without a variant.
#pragma once

#include <cstdint>

#include "collide/hull.h"
#include "vphysics/shapes.h"

namespace vp::collide {

// The last three are made of parts: they have no signed distance and no manifold of their own.
enum class Kind : std::uint8_t {
  sphere,
  capsule,
  box,
  cylinder,
  cone,
  hull,
  triangle,  // of a mesh or a height field, or a sheet of its own
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
  // Owned by whoever holds the shape.
  union {
    const HullData* hull = nullptr;
    const Vec3* corners;  // of a triangle: three, counter-clockwise seen from its front
    const MeshData* mesh;
    const HeightData* field;
    const CompoundData* compound;
  };
};

// Precondition: the shape is kept as long as the geometry is used.
Geometry make_geometry(const Shape& shape);
Geometry triangle_geometry(const Vec3 corners[3]);

inline bool is_surface(const Geometry& g) {
  return g.kind == Kind::mesh || g.kind == Kind::height_field;
}
// Bounded, and all of it in one piece.
inline bool is_convex_body(const Geometry& g) {
  return g.kind < Kind::triangle;
}
Surface surface_of(const Geometry& g);  // precondition: is_surface(g)

// Signed distance of a point in the shape's frame from its surface, negative inside, and the
// direction in which it grows fastest. The shapes are convex, hence so is the distance: it lies
// above each of its tangent planes. The sweep rests on that.
struct SignedDistance {
  double distance;
  Vec3 normal;  // unit, outward
};
SignedDistance signed_distance(const Geometry& geometry, const Vec3& point);

}  // namespace vp::collide
