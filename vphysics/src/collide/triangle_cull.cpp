#include "collide/triangle_cull.h"

#include <algorithm>
#include <cmath>

#include "collide/bounds.h"
#include "collide/polytope.h"
#include "collide/support.h"

namespace vp::collide {
namespace {

// Rounding error of a plane's distance from a corner [fraction of the lengths involved].
constexpr double kRounding = 2e-6;

}  // namespace

TriangleCull::TriangleCull(const Geometry& shape, const SE3& T, const SweptMargin& margin)
    : slack_(static_cast<float>(margin.bounds.slack + core_radius(shape))), moves_(margin.moves) {
  now_.place(shape, T, slack_);
  if (!moves_) return;
  at_end_.place(shape, margin.displacement * T, slack_);
}

// The planes are those of the core: the radius of the sphere that sweeps it is part of the slack.
void TriangleCull::Placed::place(const Geometry& shape, const SE3& T, float slack) {
  const Mat3& R = T.rotation();
  centre = T.position();
  if (shape.kind == Kind::hull) {
    const HullData& hull = *shape.hull;
    const Vec3 middle = 0.5 * (hull.lower + hull.upper);
    centre = T * middle;
    if (hull.faces.size() <= kMaxPlanes) {
      for (const ConvexHull::Face& face : hull.faces)
        add_plane(R * face.normal, face.offset - dot(face.normal, middle), slack);
    } else {
      add_box(R, 0.5 * (hull.upper - hull.lower), slack);
    }
    if (hull.vertices.size() <= kMaxCorners) {
      for (const Vec3& v : hull.vertices) add_corner(R * (v - middle));
    }
  } else if (shape.kind == Kind::box) {
    add_box(R, shape.half, slack);
    for (int i = 0; i < 8; ++i) add_corner(R * box_corner(shape.half, i));
  } else if (shape.kind == Kind::capsule) {
    add_box(R, shape.half, slack);
    add_corner(shape.half.z * R.cz);
    add_corner(-shape.half.z * R.cz);
  } else {  // sphere, cylinder, cone
    const double radial = shape.kind == Kind::sphere ? 0.0 : shape.radius;
    add_box(R, {radial, radial, shape.half.z}, slack);
  }
  extent += static_cast<double>(slack);
}

void TriangleCull::Placed::add_plane(const Vec3& outward, double offset, float slack) {
  plane[0][planes] = static_cast<float>(outward.x);
  plane[1][planes] = static_cast<float>(outward.y);
  plane[2][planes] = static_cast<float>(outward.z);
  plane[3][planes] = static_cast<float>(offset) + slack;
  ++planes;
  extent = std::max(extent, std::fabs(offset));
}

void TriangleCull::Placed::add_box(const Mat3& R, const Vec3& half, float slack) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3& along = axis == 0 ? R.cx : axis == 1 ? R.cy : R.cz;
    add_plane(along, half[axis], slack);
    add_plane(-along, half[axis], slack);
  }
}

void TriangleCull::Placed::add_corner(const Vec3& at) {
  for (int i = 0; i < 3; ++i) corner[i][corners] = static_cast<float>(at[i]);
  ++corners;
  extent = std::max(extent, norm(at));
}

// A triangle, relative to the centre of the placed shape.
struct TriangleCull::Seen {
  float q[3][3];
  float rounding;  // of a distance [m]

  Seen(const Placed& placed, const Vec3 p[3]) {
    double farthest = placed.extent;
    for (int i = 0; i < 3; ++i) {
      const Vec3 from_centre = p[i] - placed.centre;
      for (int k = 0; k < 3; ++k) {
        q[i][k] = static_cast<float>(from_centre[k]);
        farthest = std::max(farthest, std::fabs(from_centre[k]));
      }
    }
    rounding = static_cast<float>(kRounding * farthest);
  }
};

bool TriangleCull::may_overlap(const Vec3 p[3]) const {
  const Seen now(now_, p);
  const std::uint64_t beyond = planes_beyond(now_, now);
  if (beyond != 0) {
    if (!moves_) return false;
    if ((beyond & planes_beyond(at_end_, Seen(at_end_, p))) != 0) return false;
  }
  const Sides sides = sides_of(now_, now);
  if (!sides.above && !sides.below) return true;
  if (!moves_) return false;
  const Sides at_end = sides_of(at_end_, Seen(at_end_, p));
  return !(sides.above && at_end.above) && !(sides.below && at_end.below);
}

// A bit for each plane of the shape that separates the triangle.
std::uint64_t TriangleCull::planes_beyond(const Placed& placed, const Seen& t) {
  unsigned beyond[kMaxPlanes];
  unsigned any = 0;
  for (int k = 0; k < placed.planes; ++k) {
    const auto along = [&](int i) {
      return placed.plane[0][k] * t.q[i][0] + placed.plane[1][k] * t.q[i][1] +
             placed.plane[2][k] * t.q[i][2];
    };
    const float a = along(0), b = along(1), c = along(2);
    const float ab = a < b ? a : b, nearest = ab < c ? ab : c;
    beyond[k] = nearest > placed.plane[3][k] + t.rounding ? 1u : 0u;
    any |= beyond[k];
  }
  if (any == 0) return 0;
  std::uint64_t bits = 0;
  for (int k = 0; k < placed.planes; ++k) bits |= std::uint64_t{beyond[k]} << k;
  return bits;
}

// The side of the triangle's plane on which the entire shape is, if any.
TriangleCull::Sides TriangleCull::sides_of(const Placed& placed, const Seen& t) const {
  if (placed.corners == 0) return {};
  const float(&q)[3][3] = t.q;
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
  const float far = size * (slack_ + t.rounding) + t.rounding * longest;
  unsigned above = 1, below = 1;
  for (int k = 0; k < placed.corners; ++k) {
    const float d = n[0] * placed.corner[0][k] + n[1] * placed.corner[1][k] +
                    n[2] * placed.corner[2][k] - height;
    above &= d > far ? 1u : 0u;
    below &= d < -far ? 1u : 0u;
  }
  return {above != 0, below != 0};
}

}  // namespace vp::collide
