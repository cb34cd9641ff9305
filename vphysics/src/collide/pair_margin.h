// The search distance of two convex shapes at constant velocities, by the argument of
// search_margin.h: a plane that separates them at both ends of the motion separates them in
// between. So they need no contact, however fast they move.
#pragma once

#include "collide/sweep.h"

namespace vp::collide {

// A convex shape and its pose.
struct Posed {
  const Geometry& shape;
  const SE3& T;
};

class PairMargin {
 public:
  // The same in all directions, for shapes at rest.
  PairMargin(double everywhere) : largest_(everywhere), slack_(everywhere) {}
  // largest: how close to each other shapes with this motion are now, if they touch before its end.
  // slack: how close they may come to a plane between them [m]. World frame.
  PairMargin(double largest, double slack, const PairMotion& motion, const Posed& a,
             const Posed& b);

  double largest() const { return largest_; }
  double slack() const { return slack_; }
  // Whether the two, separated by so much along the unit vector n from a to b, may touch.
  bool may_touch(double separation, const Vec3& n, const Posed& a, const Posed& b) const {
    return separation <= slack_ ||
           (separation <= largest_ && separation - closing(n, a, b) <= slack_ &&
            !passes_beside(a, b));
  }

  // Of the pair (b, a).
  PairMargin reversed() const;
  PairMargin in_frame(const SE3& T) const;

 private:
  // How much nearer they are along n at the next search [m].
  double closing(const Vec3& n, const Posed& a, const Posed& b) const;
  // Whether the plane along the motion that separates the centres widest separates the shapes.
  bool passes_beside(const Posed& a, const Posed& b) const;

  double largest_, slack_;
  // Until the next search: displacement of a's origin relative to b's [m], rotations of both.
  Vec3 displacement_;
  Quaternion rotation_a_{0, 0, 0, 1}, rotation_b_{0, 0, 0, 1};
};

}  // namespace vp::collide
