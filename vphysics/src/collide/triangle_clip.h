// What of a shape's feature lies over a triangle.
#pragma once

#include <vector>

#include "collide/feature.h"
#include "collide/manifold.h"

namespace vp::collide {

// The triangle p with the normal n, unit; the feature that the shape has against n, in the same
// frame; the radius that its core is swept by.
struct ClipQuery {
  const Vec3* p;
  Vec3 n;
  const Feature& feature;
  double radius;
  double margin;  // corners that lie higher are left out
  double size;    // by which "on an edge" is measured
};

// Appends the corners of what lies over the triangle, midway between the surfaces, in order around.
// Names: of the feature's corner, of its edge and the triangle's that cross, of the triangle's
// corner; below 2^21.
void append_clipped(const ClipQuery& query, std::vector<ManifoldPoint>& points);

}  // namespace vp::collide
