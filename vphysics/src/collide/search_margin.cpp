#include "collide/search_margin.h"

#include <algorithm>
#include <cmath>

#include "collide/bounds.h"
#include "collide/gjk.h"
#include "collide/support.h"

namespace vp::collide {
namespace {

// In half extents of the shape: how far it moves in a stage, so that it is at any time over what it
// is over at one end of the stage; and how far rotation may move its farthest point.
constexpr double kStage = 2.0, kFarRotation = 0.5;

// Moves the body's points to where they are after a time.
SE3 displacement_after(const Motion& m, double time) {
  const Mat3 R = Exp(time * m.w).matrix();
  return {R, m.x + time * m.v - R * m.x};
}

}  // namespace

SearchMargin::SearchMargin(const ApproachBounds& all, const PairMotion& motion)
    : all_(all), motion_(&motion), displacement_of_b_(displacement_of_b(1.0)) {}

// Relative to a, at this fraction of the motion.
SE3 SearchMargin::displacement_of_b(double fraction) const {
  const double time = fraction * motion_->dt;
  return relative_pose(displacement_after(motion_->a, time), displacement_after(motion_->b, time));
}

ApproachBounds SearchMargin::bounds_of(const Geometry& shape, const SE3& T) const {
  if (motion_ == nullptr) return all_;
  const Vec3 centre = T * core_centre(shape);
  const double radius = core_extent(shape) + core_radius(shape);
  const Motion &a = motion_->a, &b = motion_->b;
  const double dt = motion_->dt;
  const double moved = dt * norm(b.velocity(centre) - a.velocity(centre));
  const double rotated = radius * std::min(dt * norm(b.w - a.w), 2.0);  // it stays in its ball
  const double angle_a = dt * norm(a.w), angle_b = dt * norm(b.w);
  // The path of a point of one, seen from the other, deviates from the line between its ends by at
  // most an eighth of its largest acceleration: centripetal, Coriolis, centrifugal.
  const double bend = 0.125 * (angle_a * angle_a * (norm(centre - a.x) + radius) +
                               angle_b * angle_b * (norm(centre - b.x) + radius) +
                               2.0 * (angle_a + angle_b) * (moved + rotated));
  const double largest = std::min(all_.largest, all_.slack + moved + rotated);
  const double half = min_half_extent(shape);
  const bool rotates_far = rotated > kFarRotation * half;
  const double stages = std::ceil((moved + rotated) / (kStage * half));
  return {largest, rotates_far ? largest : std::min(largest, all_.slack + bend),
          static_cast<int>(std::clamp(stages, 1.0, 1.0 * SweptMargin::kMaxStages))};
}

SweptMargin SearchMargin::swept(const ApproachBounds& bounds, bool moves_b, const SE3& T) const {
  SweptMargin margin(bounds.largest);
  if (motion_ == nullptr) return margin;
  margin.bounds = bounds;
  margin.stages = bounds.stages;
  for (int k = 1; k <= bounds.stages; ++k) {
    const bool is_last = k == bounds.stages;
    const SE3 displaced =
        (is_last ? displacement_of_b_ : displacement_of_b(1.0 * k / bounds.stages)) * T;
    margin.displacement[k - 1] =
        moves_b ? relative_pose(T, displaced) : relative_pose(displaced, T);
  }
  return margin;
}

}  // namespace vp::collide
