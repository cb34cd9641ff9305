// Repairs inertias of robot files: dummy links, rounded values, wrong axes. Inertias that the
// dynamics can use are accepted as given, even if no physical body has them. The others are changed
// as little as possible.
#pragma once

#include <vector>

#include "vphysics/multibody/model.h"

namespace vp::detail {

// Validity of the moments about the centre of mass.
enum class StatedMoments {
  physical,
  non_physical,  // positive semidefinite, but one exceeds the sum of the others, or no mass
  negative,      // a negative principal moment
};
StatedMoments judged(double mass, const Sym3& moments);
// The nearest positive semidefinite moments: negative principal moments become zero.
Sym3 without_negative(const Sym3& moments);

// Gives an armature to links whose joint moves no mass, neither their own nor that of descendants:
// forward dynamics would divide by zero. The armature is a millionth of the robot's mass (times its
// squared length), which is negligible beside any link with mass. Returns these links in order.
// Precondition: parents come before their children.
std::vector<int> add_armatures(std::vector<LinkSpec>& links);

}  // namespace vp::detail
