// What a Compound holds: constant once built, shared by everything that uses the compound.
#pragma once

#include <vector>

#include "collide/bounding_tree.h"
#include "collide/geometry.h"

namespace vp::collide {

struct CompoundData {
  std::vector<CompoundPart> parts;
  std::vector<Geometry> geometries;  // of the parts, which keep what these point to
  BoundingTree tree;                 // of the parts' bounds
  Vec3 lower, upper;                 // bounds
  Inertia unit;                      // of density 1
};

}  // namespace vp::collide
