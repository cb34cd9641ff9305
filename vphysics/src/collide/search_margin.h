// The search distance of contacts. It is large enough that whatever closes in before the next
// search is found now.
//
// A plane that separates two shapes at their present poses and at those of the next search, by more
// than a small slack, separates them in between. So a shape that slides past a surface, or rolls on
// it, searches little of it, however fast it is.
#pragma once

#include <optional>

#include "collide/pair_margin.h"
#include "collide/sweep.h"

namespace vp::collide {

// How far two shapes may approach each other until the next search [m]:
// touching <= slack <= largest.
struct ApproachBounds {
  double largest;   // in any direction
  double slack;     // a plane that separates them by more at both ends separates them in between
  double touching;  // what comes so close along its motion touches
  // Rotation moves the shape far, compared with its smallest extent: it may touch with other
  // features than those that are close at either end. Then the slack is the largest.
  bool rotates_far = false;
};

// Of a convex shape b and another shape a, in a frame in which a stands still.
struct SweptMargin {
  // Without motion.
  explicit SweptMargin(double everywhere) : bounds{everywhere, everywhere, everywhere} {}
  SweptMargin(const ApproachBounds& of_both, const SE3& displacement_of_b);

  // Whether the point x of b, at this separation from a along n, is so close now or at the next
  // search that it may touch a. n: unit, from a to b.
  bool may_touch(double separation, const Vec3& n, const Vec3& x) const {
    return separation <= bounds.slack ||
           (moves && separation + dot(n, displacement * x - x) <= bounds.slack);
  }
  // The displacement up to a fraction of the motion, along which the point `centre` moves straight.
  SE3 part_of_displacement(double fraction, const Vec3& centre) const;

  ApproachBounds bounds;
  bool moves = false;
  SE3 displacement;  // of b until the next search: moves its point x to displacement * x
  Vec3 rotation;     // the same as a rotation vector [rad]
};

// Of a pair of shapes, which may have parts. World frame.
class SearchMargin {
 public:
  // The same everywhere.
  SearchMargin(double everywhere) : all_{everywhere, everywhere, everywhere} {}
  // motion: of both until the next search. at_rest: the margin without it. pushed: how far others
  // may move them beside that motion.
  SearchMargin(double largest, double at_rest, double pushed, const PairMotion& motion);

  const ApproachBounds& all() const { return all_; }
  const PairMotion* motion() const { return motion_ ? &*motion_ : nullptr; }  // null: none
  // Of a convex shape in this pose, b or a part of it, or else of a.
  ApproachBounds approach_of(const Geometry& shape, const SE3& T, bool is_b) const;
  // Of two convex shapes of this pair, or parts of them. largest: the smallest of the bounds of the
  // shapes that they are, or are parts of. What pushes them counts in the slack alone.
  PairMargin of_convex(double largest, const Posed& a, const Posed& b) const;
  // In the frame of the other shape, which has the pose T.
  SweptMargin swept(const ApproachBounds& bounds, bool moves_b, const SE3& T) const;

 private:
  ApproachBounds all_;
  double pushed_ = 0.0;
  std::optional<PairMotion> motion_;
  SE3 displacement_of_b_;  // relative to a, until the next search
};

}  // namespace vp::collide
