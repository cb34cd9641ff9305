// Which triangles a convex shape is surely too far from, told cheaply, so that few are left for the
// narrow phase: by separating planes, those of the shape's faces or of its box, and the triangle's.
#pragma once

#include "collide/geometry.h"

namespace vp::collide {

class TriangleCull {
 public:
  // Precondition: is_convex_body(shape). margin: what is farther apart need not be found [m].
  TriangleCull(const Geometry& shape, const SE3& T_surface_shape, double margin);

  // False: they are farther apart than the margin. p: corners in the surface's frame.
  bool may_overlap(const Vec3 p[3]) const;

 private:
  static constexpr int kMaxPlanes = 64, kMaxCorners = 64;

  void add_plane(const Vec3& outward, double offset);
  void add_box(const Mat3& R, const Vec3& half);
  void add_corner(const Vec3& corner);
  bool is_beyond_a_plane(const float q[3][3], float slack) const;
  bool is_off_its_plane(const float q[3][3], float slack) const;

  // In single precision and about the shape's middle, in the surface's axes.
  Vec3 centre_;
  float margin_;
  double extent_ = 0.0;  // farthest corner or plane
  int planes_ = 0, corners_ = 0;
  float plane_[4][kMaxPlanes];    // outward normal; what lies farther along it is beyond the margin
  float corner_[3][kMaxCorners];  // of the core; none: they are too many, or there are none
};

}  // namespace vp::collide
