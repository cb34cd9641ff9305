// Penetration depth of two convex cores: the expanding polytope algorithm.
#pragma once

#include "collide/gjk.h"

namespace vp::collide {

struct Penetration {
  double depth;     // translation of b along normal until it touches a; <= 0: touching or separated
  double at_least;  // lower bound over all directions
  Vec3 normal;      // unit, from a to b
  Vec3 on_a, on_b;
};

// Starts from the simplex with which GJK found an overlap. The separation along normal is -depth
// exactly, so moving b by depth does separate the two, despite rounding. No other direction needs
// less, up to 1e-9 of the pair's extent. Stops as soon as no direction needs less than `enough`:
// depth is then only an upper bound.
Penetration epa(const CorePair& pair, const Simplex& simplex, double enough);

}  // namespace vp::collide
