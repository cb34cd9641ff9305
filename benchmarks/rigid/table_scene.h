// The foosball table with any number of balls. Its walls and balls are a scene; its rods are
// articulations of Virtual Physics.
#pragma once

#include <vector>

#include "scenes/scene.h"
#include "vphysics/world.h"

namespace rigid {

inline constexpr int kMaxBalls = 1000;
// Precondition: 1 <= balls <= kMaxBalls. A single ball rolls; several fall between the rods.
scenes::Scene table_scene(int balls);

// Eight rods of four men each, with strong drives whose targets swing and slide at random.
class Rods {
 public:
  static vp::Expected<Rods> create(vp::World& world);
  // Call before each step, with its number: sets new targets ten times a second.
  void drive(vp::World& world, long step);

 private:
  std::vector<vp::ArticulationId> rods_;
};

}  // namespace rigid
