#include "collide/search_margin.h"

#include <algorithm>
#include <cmath>

#include "collide/bounds.h"
#include "collide/gjk.h"
#include "collide/support.h"

namespace vp::collide {
namespace {

// In half extents of the shape: how far rotation may move its farthest point.
constexpr double kFarRotation = 0.5;
// A motion near a surface that rotates further is not followed [rad]: the solver moves the shape
// along a line, and keeps the normal that the surface has at the start.
constexpr double kFollowed = 0.02;

// Moves the body's points to where they are after a time.
SE3 displacement_after(const Motion& m, double time) {
  const Mat3 R = Exp(time * m.w).matrix();
  return {R, m.x + time * m.v - R * m.x};
}

}  // namespace

SweptMargin::SweptMargin(const ApproachBounds& of_both, const SE3& displacement_of_b)
    : bounds(of_both),
      moves(true),
      displacement(displacement_of_b),
      rotation(Log(SO3(displacement_of_b.rotation()))) {}

SE3 SweptMargin::part_of_displacement(double fraction, const Vec3& centre) const {
  const Mat3 R = Exp(fraction * rotation).matrix();
  return {R, centre + fraction * (displacement * centre - centre) - R * centre};
}

SearchMargin::SearchMargin(double largest, double at_rest, double pushed, const PairMotion& motion)
    : all_{largest, at_rest, at_rest},
      pushed_(pushed),
      motion_(motion),
      displacement_of_b_(relative_pose(displacement_after(motion.a, motion.dt),
                                       displacement_after(motion.b, motion.dt))) {}

ApproachBounds SearchMargin::approach_of(const Geometry& shape, const SE3& T, bool is_b) const {
  if (!motion_) return all_;
  const Vec3 centre = T * core_centre(shape);
  const double radius = core_extent(shape) + core_radius(shape), dt = motion_->dt;
  const Motion &own = is_b ? motion_->b : motion_->a, &other = is_b ? motion_->a : motion_->b;
  const double moved = dt * norm(own.velocity(centre) - other.velocity(centre));
  const double rotated =
      radius * std::min(dt * norm(own.w - other.w), 2.0);  // it stays in its ball
  const double largest = std::min(all_.largest, all_.slack + moved + rotated);
  const double angle = dt * norm(own.w), angle_of_other = dt * norm(other.w);
  if (angle_of_other > kFollowed) return {largest, largest, largest};
  // The path of a point deviates from the line between its ends by at most an eighth of its largest
  // acceleration: centripetal, and seen from the other body Coriolis and centrifugal. Seen from the
  // shape, so does that of a point of the other body.
  const double coriolis = 2.0 * (moved + rotated);
  const double bend = 0.125 * (angle * angle * (norm(centre - own.x) + radius) +
                               angle_of_other * angle_of_other * (norm(centre - other.x) + radius) +
                               angle_of_other * coriolis);
  const double own_bend = 0.125 * angle * (coriolis + angle * moved);
  const bool rotates_far = rotated > kFarRotation * min_half_extent(shape);
  const double slack = rotates_far ? largest : all_.slack + bend + own_bend;
  return {largest, std::min(largest, slack), std::min(largest, all_.touching + bend), rotates_far};
}

PairMargin SearchMargin::of_convex(double largest, const Posed& a, const Posed& b) const {
  const double slack = all_.slack + pushed_;
  if (!motion_ || slack >= largest) return PairMargin(largest);
  return {largest, slack, *motion_, a, b};
}

SweptMargin SearchMargin::swept(const ApproachBounds& bounds, bool moves_b, const SE3& T) const {
  if (!motion_ || bounds.touching >= bounds.largest) return SweptMargin(bounds.largest);
  const SE3 displaced = displacement_of_b_ * T;
  return {bounds, moves_b ? relative_pose(T, displaced) : relative_pose(displaced, T)};
}

}  // namespace vp::collide
