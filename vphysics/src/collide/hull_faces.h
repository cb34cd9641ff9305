// From the triangles of a hull to its faces.
#pragma once

#include <span>
#include <vector>

#include "collide/quickhull.h"
#include "vphysics/lie.h"

namespace vp::collide {

using Loop = std::vector<std::uint32_t>;  // corners, counter-clockwise from outside

// Twice the area of a loop along its normal: the sum of its triangles', so that thin ones count for
// little.
Vec3 area_vector(std::span<const Vec3> points, std::span<const std::uint32_t> loop);
// a / |a|, or some unit vector if that is nothing.
Vec3 unit(const Vec3& a);

// Corners in the midst of a face: all triangles around lie within tolerance of one plane. No two of
// them are neighbours; the flattest first.
std::vector<std::uint32_t> flat_corners(std::span<const Vec3> points,
                                        std::span<const Triangle> triangles, double tolerance);

// Convex polygons made by joining neighbours of which all corners lie within tolerance of one
// plane, the flattest first. Every corner that is left has at least three faces, every edge two.
std::vector<Loop> faces_of(std::span<const Vec3> points, std::span<const Triangle> triangles,
                           double tolerance);

}  // namespace vp::collide
