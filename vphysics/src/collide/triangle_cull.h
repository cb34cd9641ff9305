// A cheap conservative test that rejects triangles too far from a convex shape, so that few are
// left for the narrow phase. It uses separating planes: of the shape's faces or of its box, and of
// the triangle.
#pragma once

#include <cstdint>

#include "collide/search_margin.h"

namespace vp::collide {

class TriangleCull {
 public:
  // Precondition: is_convex_body(shape). margin: of the surface and the shape, in that order and
  // frame.
  TriangleCull(const Geometry& shape, const SE3& T_surface_shape, const SweptMargin& margin);

  // Returns false if a plane of one of them separates both by more than the slack, now and at the
  // next search. p: corners in the surface's frame.
  bool may_overlap(const Vec3 p[3]) const;

 private:
  static constexpr int kMaxPlanes = 64, kMaxCorners = 64;

  // The core in a pose, in single precision, relative to its centre, in the surface's axes.
  struct Placed {
    Vec3 centre;
    double extent = 0.0;  // of the farthest corner or plane
    int planes = 0, corners = 0;
    // Outward normal and offset; points beyond it are farther than the slack.
    float plane[4][kMaxPlanes];
    float corner[3][kMaxCorners];  // empty if there are too many, or none

    void place(const Geometry& shape, const SE3& T, float slack);

   private:
    void add_plane(const Vec3& outward, double offset, float slack);
    void add_box(const Mat3& R, const Vec3& half, float slack);
    void add_corner(const Vec3& at);
  };
  struct Seen;
  struct Sides {
    bool above = false, below = false;
  };

  static std::uint64_t planes_beyond(const Placed& placed, const Seen& triangle);
  Sides sides_of(const Placed& placed, const Seen& triangle) const;

  float slack_;
  Placed now_;
  bool moves_;
  Placed at_end_;  // if it moves
};

}  // namespace vp::collide
