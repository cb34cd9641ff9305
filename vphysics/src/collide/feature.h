// The feature of a core that faces a direction: a face, an edge or a vertex.
#pragma once

#include <cstdint>

#include "collide/support.h"

namespace vp::collide {

// Of a face with more corners, every second or fourth is used.
inline constexpr int kMaxCorners = 64;

// No default initializers: thousands of features are made per step, and only the first corners are
// used.
struct FeatureCorner {
  double x, y, z;
  // Names, within the shape, of the corner and of the edge to the next one; below 2^15.
  std::uint16_t name, edge;

  Vec3 at() const { return {x, y, z}; }
};

// A polygon, counter-clockwise seen from outside; a segment; or a point. For an edge or an apex it
// is an adjacent face that contains it: points too far behind are later rejected by their distance.
struct Feature {
  int count;
  double normal_x, normal_y, normal_z;  // with three corners or more: unit, outward
  FeatureCorner corners[kMaxCorners];

  Vec3 normal() const { return {normal_x, normal_y, normal_z}; }
};

// Finds the feature of the core that is farthest in the direction d, with its corners in the outer
// frame of T. d is in the core's own frame.
void find_feature(const Geometry& g, const SE3& T, const Vec3& d, Feature& feature);

// Face f of a box or a hull.
void face_feature(const Geometry& g, const SE3& T, int f, Feature& feature);

}  // namespace vp::collide
