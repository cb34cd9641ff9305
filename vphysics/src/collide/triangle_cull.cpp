#include "collide/triangle_cull.h"

#include <algorithm>
#include <cmath>

#include "collide/bounds.h"
#include "collide/support.h"

namespace vp::collide {
namespace {

// Rounding error of a plane's distance from a corner [fraction of the lengths involved].
constexpr double kRounding = 2e-6;

}  // namespace

TriangleCull::TriangleCull(const Geometry& shape, const SE3& T, double margin) {
  const Mat3& R = T.rotation();
  // For a core swept by a sphere, the planes are those of the core; the sphere's radius is part of
  // the margin.
  const double radius = core_radius(shape);
  margin_ = static_cast<float>(margin + radius);
  centre_ = T.position();
  if (shape.kind == Kind::hull) {
    const HullData& hull = *shape.hull;
    const Vec3 centre = 0.5 * (hull.lower + hull.upper);
    centre_ = T * centre;
    if (hull.faces.size() <= kMaxPlanes) {
      for (std::size_t f = 0; f < hull.faces.size(); ++f) {
        const ConvexHull::Face& face = hull.faces[f];
        add_plane(R * face.normal, face.offset - dot(face.normal, centre));
      }
    } else {
      add_box(R, 0.5 * (hull.upper - hull.lower));
    }
    if (hull.vertices.size() <= kMaxCorners) {
      for (const Vec3& v : hull.vertices) add_corner(R * (v - centre));
    }
  } else if (shape.kind == Kind::box) {
    add_box(R, shape.half);
    for (int i = 0; i < 8; ++i) {
      const auto along = [&](int axis) {
        return (i >> axis & 1) != 0 ? shape.half[axis] : -shape.half[axis];
      };
      add_corner(R * Vec3{along(0), along(1), along(2)});
    }
  } else if (shape.kind == Kind::capsule) {
    add_box(R, shape.half);
    add_corner(shape.half.z * R.cz);
    add_corner(-shape.half.z * R.cz);
  } else {  // sphere, cylinder, cone
    const double radial = shape.kind == Kind::sphere ? 0.0 : shape.radius;
    add_box(R, {radial, radial, shape.half.z});
  }
}

void TriangleCull::add_plane(const Vec3& outward, double offset) {
  plane_[0][planes_] = static_cast<float>(outward.x);
  plane_[1][planes_] = static_cast<float>(outward.y);
  plane_[2][planes_] = static_cast<float>(outward.z);
  plane_[3][planes_] = static_cast<float>(offset) + margin_;
  ++planes_;
  extent_ = std::max(extent_, std::fabs(offset));
}

void TriangleCull::add_box(const Mat3& R, const Vec3& half) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3& along = axis == 0 ? R.cx : axis == 1 ? R.cy : R.cz;
    add_plane(along, half[axis]);
    add_plane(-along, half[axis]);
  }
}

void TriangleCull::add_corner(const Vec3& corner) {
  for (int i = 0; i < 3; ++i) corner_[i][corners_] = static_cast<float>(corner[i]);
  ++corners_;
  extent_ = std::max(extent_, norm(corner));
}

bool TriangleCull::may_overlap(const Vec3 p[3]) const {
  float q[3][3];
  double farthest = extent_ + static_cast<double>(margin_);
  for (int i = 0; i < 3; ++i) {
    const Vec3 from_centre = p[i] - centre_;
    for (int k = 0; k < 3; ++k) {
      q[i][k] = static_cast<float>(from_centre[k]);
      farthest = std::max(farthest, std::fabs(from_centre[k]));
    }
  }
  const auto slack = static_cast<float>(kRounding * farthest);
  return !is_beyond_a_plane(q, slack) && !is_off_its_plane(q, slack);
}

bool TriangleCull::is_beyond_a_plane(const float q[3][3], float slack) const {
  unsigned beyond = 0;
  for (int k = 0; k < planes_; ++k) {
    const auto along = [&](int i) {
      return plane_[0][k] * q[i][0] + plane_[1][k] * q[i][1] + plane_[2][k] * q[i][2];
    };
    const float a = along(0), b = along(1), c = along(2);
    const float ab = a < b ? a : b, nearest = ab < c ? ab : c;
    beyond |= nearest > plane_[3][k] + slack ? 1u : 0u;
  }
  return beyond != 0;
}

// Whether the shape is entirely on one side of the triangle's plane.
bool TriangleCull::is_off_its_plane(const float q[3][3], float slack) const {
  if (corners_ == 0) return false;
  float e[2][3];
  for (int k = 0; k < 3; ++k) {
    e[0][k] = q[1][k] - q[0][k];
    e[1][k] = q[2][k] - q[0][k];
  }
  const float n[3] = {e[0][1] * e[1][2] - e[0][2] * e[1][1], e[0][2] * e[1][0] - e[0][0] * e[1][2],
                      e[0][0] * e[1][1] - e[0][1] * e[1][0]};
  const float size = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  const float height = n[0] * q[0][0] + n[1] * q[0][1] + n[2] * q[0][2];
  // For thin triangles the normal itself is inaccurate: by rounding errors of the longer edges.
  const float longest = std::max(e[0][0] * e[0][0] + e[0][1] * e[0][1] + e[0][2] * e[0][2],
                                 e[1][0] * e[1][0] + e[1][1] * e[1][1] + e[1][2] * e[1][2]);
  const float far = size * (margin_ + slack) + slack * longest;
  unsigned above = 1, below = 1;
  for (int k = 0; k < corners_; ++k) {
    const float d = n[0] * corner_[0][k] + n[1] * corner_[1][k] + n[2] * corner_[2][k] - height;
    above &= d > far ? 1u : 0u;
    below &= d < -far ? 1u : 0u;
  }
  return (above | below) != 0;
}

}  // namespace vp::collide
