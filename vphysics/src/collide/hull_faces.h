// Merges the triangles of a hull into faces.
#pragma once

#include <span>
#include <vector>

#include "collide/quickhull.h"
#include "vphysics/lie.h"

namespace vp::collide {

using Loop = std::vector<std::uint32_t>;  // corners, counter-clockwise from outside

// Twice the area of a loop along its normal. It is the sum over the loop's triangles, so thin ones
// have little weight.
Vec3 area_vector(std::span<const Vec3> points, std::span<const std::uint32_t> loop);
// a / |a|, or an arbitrary unit vector if a is zero.
Vec3 unit(const Vec3& a);

// Vertices inside a face: all triangles around one are within tolerance of a plane. No two of them
// are neighbours; the flattest first.
std::vector<std::uint32_t> flat_corners(std::span<const Vec3> points,
                                        std::span<const Triangle> triangles, double tolerance);

// Merges neighbours whose corners are all within tolerance of a plane into convex polygons, the
// flattest first. Every remaining corner has at least three faces, every edge two.
std::vector<Loop> faces_of(std::span<const Vec3> points, std::span<const Triangle> triangles,
                           double tolerance);

}  // namespace vp::collide
