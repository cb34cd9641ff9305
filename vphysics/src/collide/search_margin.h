// The search distance of contacts. It is large enough that whatever closes in before the next
// search is found now.
//
// A plane that separates two shapes at their present poses and at those of the next search, by more
// than a small slack, separates them in between. So a shape that slides past a surface, or rolls on
// it, searches little of it, however fast it is.
#pragma once

#include "collide/sweep.h"

namespace vp::collide {

// How far two shapes may approach each other until the next search [m].
struct ApproachBounds {
  double largest;  // in any direction, with the slack
  double slack;  // how much closer they may be in between than at both ends, and the margin at rest
  int stages = 1;  // of the motion: in each, a shape moves about as far as its own extent
};

// Of a convex shape b and another shape a, in a frame in which a stands still.
struct SweptMargin {
  static constexpr int kMaxStages = 8;

  // Without motion.
  explicit SweptMargin(double everywhere) : bounds{everywhere, everywhere} {}

  bool moves() const { return stages > 0; }
  // The displacement of b until the next search: moves its point x to to_end() * x.
  const SE3& to_end() const { return displacement[stages - 1]; }
  // How close b may be at the end of a stage in which it touches a.
  double of_stage() const { return bounds.largest / stages; }
  // Whether the point x of b, at this separation from a along n, is so close now or at the next
  // search that it may touch a. n: unit, from a to b.
  bool may_touch(double separation, const Vec3& n, const Vec3& x) const {
    return separation <= bounds.slack ||
           (moves() && separation + dot(n, to_end() * x - x) <= bounds.slack);
  }

  ApproachBounds bounds;
  int stages = 0;
  SE3 displacement[kMaxStages];  // of b at the end of each stage
};

// Of a pair of shapes, which may have parts. World frame.
class SearchMargin {
 public:
  // The same everywhere.
  SearchMargin(double everywhere) : all_{everywhere, everywhere} {}
  // motion: of both until the next search; it is referred to. all: of the pair, at its least slack.
  SearchMargin(const ApproachBounds& all, const PairMotion& motion);

  const ApproachBounds& all() const { return all_; }
  const PairMotion* motion() const { return motion_; }  // null: none
  // Of a convex shape in this pose. One that rotates far, compared with its smallest extent, may
  // touch with other features than those that are close at either end: its slack is the largest.
  ApproachBounds bounds_of(const Geometry& shape, const SE3& T) const;
  // In the frame of the other shape, which has the pose T.
  SweptMargin swept(const ApproachBounds& bounds, bool moves_b, const SE3& T) const;

 private:
  SE3 displacement_of_b(double fraction) const;

  ApproachBounds all_;
  const PairMotion* motion_ = nullptr;
  SE3 displacement_of_b_;  // relative to a, until the next search
};

}  // namespace vp::collide
