// What the stage of impacts remembers of pairs of colliders, and tells of their contacts.
#pragma once

#include <cstdint>

#include "collide/manifold.h"
#include "vphysics/world.h"

namespace vp {

struct PairPoint {
  std::uint32_t feature;
  double normal_impulse;
  Vec3 friction;  // world frame
  Vec3 position;  // world frame
};

// What is remembered of a pair of colliders from step to step.
struct PairRecord {
  std::uint64_t key = 0;  // serials of both
  std::uint32_t a = 0, b = 0;
  std::uint32_t part = 0;  // number of the manifold, of pairs with several
  std::uint32_t count = 0;
  bool touching = false;  // the pair: only of part 0
  Vec3 rolling;
  PairPoint points[collide::kMaxPoints]{};
};

// A pair that touched when one of the two was destroyed; the next step reports its end. user_data
// is not kept: it is the user's and no snapshot carries it.
struct DestroyedPair {
  ColliderId a, b;
  bool sensor = false;
};

// A point of the impacts of a step, or of a link in its sub-steps.
struct StepContact {
  ColliderId a, b;
  Vec3 point, normal;  // from a to b
  double impulse = 0.0;
  Vec3 friction;  // on b
};

}  // namespace vp
