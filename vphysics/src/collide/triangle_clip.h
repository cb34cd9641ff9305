// Clips a shape's feature to a triangle.
#pragma once

#include <vector>

#include "collide/feature.h"
#include "collide/manifold.h"

namespace vp::collide {

// The triangle p with the unit normal n; the shape's feature that faces -n, in the same frame; the
// radius of the sphere that sweeps its core.
struct ClipQuery {
  const Vec3* p;
  Vec3 n;
  const Feature& feature;
  double radius;
  double margin;  // rejects corners that are higher
  double size;    // scale of the tolerance for points on an edge
};

// Appends the corners of the part of the feature over the triangle, midway between the surfaces, in
// order around it. Names are those of the feature's corner, of the crossing of its edge with the
// triangle's, or of the triangle's corner; below 2^21.
void append_clipped(const ClipQuery& query, std::vector<ManifoldPoint>& points);

}  // namespace vp::collide
