// Inertias as robots' files have them: of dummy links, rounded, turned wrong. What dynamics can
// work with is taken as it stands, though no body may have it; the rest is mended, as little as
// possible.
#pragma once

#include <vector>

#include "vphysics/multibody/model.h"

namespace vp::detail {

// Moments about the centre of mass.
enum class StatedMoments {
  of_a_body,
  of_no_body,  // positive semidefinite, but one is more than the two others together, or no mass
  negative,    // one of the principal moments
};
StatedMoments judged(double mass, const Sym3& moments);
// Positive semidefinite: negative principal moments become zero.
Sym3 without_negative(const Sym3& moments);

// Links by whose joint nothing moves, neither themselves nor what hangs on them: forward dynamics
// would divide by zero. Each is given an armature: a millionth of the whole, which next to anything
// that has a mass is nothing. In the order of the links; a link's parent comes before it.
std::vector<int> give_armatures(std::vector<LinkSpec>& links);

}  // namespace vp::detail
