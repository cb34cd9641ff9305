// The data of a Compound: constant once built, shared by all users of the compound.
#pragma once

#include <vector>

#include "collide/bounding_tree.h"
#include "collide/geometry.h"

namespace vp::collide {

struct CompoundData {
  std::vector<CompoundPart> parts;
  std::vector<Geometry> geometries;  // of the parts, which own what these point to
  BoundingTree tree;                 // of the parts' bounds
  Vec3 lower, upper;                 // bounds
  Inertia unit;                      // at density 1
};

}  // namespace vp::collide
