// Where does a ray enter a shape?
#pragma once

#include "collide/bounding_tree.h"
#include "collide/geometry.h"

namespace vp::collide {

struct Ray {
  Vec3 origin, direction;  // the direction of unit length
};

struct RayEntry {
  double distance;         // 0 where the ray starts inside
  Vec3 normal;             // unit, outward; starting inside, that of the nearest surface
  std::uint32_t part = 0;  // of a compound, or the triangle of a surface
};

// Any shape; ray and entry in the shape's frame. False: it does not come into it within the limit
// [m]. One-sided triangles are met from their front alone; of what is met at one distance the part
// with the lowest number.
bool cast_ray(const Geometry& geometry, const Ray& ray, double limit, CastScratch& scratch,
              RayEntry& entry);

}  // namespace vp::collide
