// What of a core a neighbour touches when it comes from a direction: a face, an edge or a point.
#pragma once

#include <cstdint>

#include "collide/support.h"

namespace vp::collide {

inline constexpr int kMaxCorners = 64;  // of a face with more, every second or fourth is used

// No defaults: a feature is made thousands of times a step, and only its first corners are used.
struct FeatureCorner {
  double x, y, z;
  // Names within the shape of the corner and of the edge to the next one, below 2^15.
  std::uint16_t name, edge;

  Vec3 at() const { return {x, y, z}; }
};

// A polygon, counter-clockwise seen from outside; a segment; a point. Of an edge as of an apex the
// neighbouring face is told, which holds it: what lies too far behind is left out by its distance.
struct Feature {
  int count;
  double normal_x, normal_y, normal_z;  // of three corners or more: unit, outward
  FeatureCorner corners[kMaxCorners];

  Vec3 normal() const { return {normal_x, normal_y, normal_z}; }
};

// The feature of the core that lies farthest in the direction d, with its corners in the outer
// frame of T. d is in the core's own frame.
void find_feature(const Geometry& g, const SE3& T, const Vec3& d, Feature& feature);

// Face number f of a box or a hull.
void face_feature(const Geometry& g, const SE3& T, int f, Feature& feature);

}  // namespace vp::collide
