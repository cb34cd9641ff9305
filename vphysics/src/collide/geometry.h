// Shapes as the engine keeps them: flat, without a variant.
#pragma once

#include <cstdint>

#include "collide/hull.h"
#include "vphysics/shapes.h"

namespace vp::collide {

enum class Kind : std::uint8_t { sphere, capsule, box, cylinder, cone, hull, half_space };

struct Geometry {
  Kind kind = Kind::sphere;
  double radius = 0.0;  // sphere, capsule, cylinder; of a cone's base
  Vec3 half;            // box: half extents; capsule, cylinder, cone: (0, 0, half length)
  const HullData* hull = nullptr;  // owned by whoever holds the shape
};

// Precondition: the shape is kept as long as the geometry is used.
Geometry make_geometry(const Shape& shape);

// Signed distance of a point in the shape's frame from its surface, negative inside, and the
// direction in which it grows fastest. The shapes are convex, hence so is the distance: it lies
// above each of its tangent planes. The sweep rests on that.
struct SignedDistance {
  double distance;
  Vec3 normal;  // unit, outward
};
SignedDistance signed_distance(const Geometry& geometry, const Vec3& point);

}  // namespace vp::collide
