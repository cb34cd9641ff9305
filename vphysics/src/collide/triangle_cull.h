// A cheap conservative test that rejects triangles too far from a convex shape, so that few are
// left for the narrow phase. It uses separating planes: of the shape's faces or of its box, and of
// the triangle.
#pragma once

#include "collide/geometry.h"

namespace vp::collide {

class TriangleCull {
 public:
  // Precondition: is_convex_body(shape). margin: pairs with a larger separation need not be found
  // [m].
  TriangleCull(const Geometry& shape, const SE3& T_surface_shape, double margin);

  // Returns false if they are separated by more than the margin. p: corners in the surface's frame.
  bool may_overlap(const Vec3 p[3]) const;

 private:
  static constexpr int kMaxPlanes = 64, kMaxCorners = 64;

  void add_plane(const Vec3& outward, double offset);
  void add_box(const Mat3& R, const Vec3& half);
  void add_corner(const Vec3& corner);
  bool is_beyond_a_plane(const float q[3][3], float slack) const;
  bool is_off_its_plane(const float q[3][3], float slack) const;

  // In single precision, relative to the shape's centre, in the surface's axes.
  Vec3 centre_;
  float margin_;
  double extent_ = 0.0;  // of the farthest corner or plane
  int planes_ = 0, corners_ = 0;
  // Outward normal and offset; points beyond it are farther than the margin.
  float plane_[4][kMaxPlanes];
  float corner_[3][kMaxCorners];  // of the core; empty if there are too many, or none
};

}  // namespace vp::collide
