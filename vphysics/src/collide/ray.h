// Ray casts against shapes.
#pragma once

#include "collide/bounding_tree.h"
#include "collide/geometry.h"

namespace vp::collide {

struct Ray {
  Vec3 origin, direction;  // direction: unit length
};

struct RayEntry {
  double distance;         // 0 if the ray starts inside
  Vec3 normal;             // unit, outward; if the ray starts inside, of the nearest surface
  std::uint32_t part = 0;  // of a compound, or the triangle of a surface
};

// Casts a ray against any shape; ray and entry are in the shape's frame. Returns false if it does
// not hit within the limit [m]. One-sided triangles are hit from the front only. Of hits at equal
// distance the part with the lowest number is reported.
bool cast_ray(const Geometry& geometry, const Ray& ray, double limit, CastScratch& scratch,
              RayEntry& entry);

}  // namespace vp::collide
