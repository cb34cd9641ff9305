// How deep two convex cores overlap: the expanding polytope algorithm.
#pragma once

#include "collide/gjk.h"

namespace vp::collide {

struct Penetration {
  double depth;     // moved by this along the normal, b touches a; 0 or less: touching or apart
  double at_least;  // no direction needs less
  Vec3 normal;      // unit, from a to b
  Vec3 on_a, on_b;
};

// From the simplex with which gjk found that they overlap. The gap along normal is -depth exactly,
// so b moved by depth does separate, whatever rounding does; that no other direction needs less is
// found to within 1e-9 of the pair's reach. Stops as soon as none needs less than enough: depth is
// then no more than an upper bound.
Penetration epa(const CorePair& pair, const Simplex& simplex, double enough);

}  // namespace vp::collide
