// The foosball table with any number of balls: its walls and balls as a scene, its rods as what
// Virtual Physics has for them.
#pragma once

#include <vector>

#include "scenes/scene.h"
#include "vphysics/world.h"

namespace rigid {

inline constexpr int kMostBalls = 1000;
// Precondition: 1 <= balls <= kMostBalls. One ball rolls; more are let fall between the rods.
scenes::Scene table_scene(int balls);

// Eight rods of four men each, driven as by strong hands that swing and slide without a plan.
class Rods {
 public:
  static vp::Expected<Rods> create(vp::World& world);
  // Before the step of that number: new targets, ten times a second.
  void drive(vp::World& world, long step);

 private:
  std::vector<vp::ArticulationId> rods_;
};

}  // namespace rigid
