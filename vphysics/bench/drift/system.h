// The systems whose energy and momentum are measured, and the interface of an engine.
//
// Every engine reports its state in the convention of Virtual Physics, so that the same code
// computes energy and momentum for all of them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "vphysics/multibody/dynamics.h"

namespace vp::bench {

inline constexpr double kStep = 1e-3;  // [s], the game's

struct State {
  std::vector<double> q, v;
};

struct System {
  std::string name;
  Model model;
  State start;
  Vec3 gravity;
  double energy_scale;    // [J]; errors of energy are divided by it
  double momentum_scale;  // [N m s] the same for angular momentum; 0: not conserved
};

// A free body with moments of inertia 0.2, 0.35 and 0.5 kg m^2, without gravity. It rotates at 3
// rad/s mostly about the intermediate axis, so it tumbles.
System tumbling_body();
// Ten rods of 0.2 m and 1 kg on parallel hinges, released from a horizontal line. The motion is
// chaotic, so only the energy can be compared.
System ten_link_pendulum();

// A system simulated by one integrator of one engine.
class Mover {
 public:
  virtual ~Mover() = default;
  virtual void advance(int steps) = 0;  // of kStep
  virtual State state() const = 0;
  bool failed = false;  // the integrator failed and cannot continue

  std::string name;  // "engine: integrator"
};

std::vector<std::unique_ptr<Mover>> our_movers(const System& system);
std::vector<std::unique_ptr<Mover>> mujoco_movers(const System& system);
std::vector<std::unique_ptr<Mover>> dart_movers(const System& system);

}  // namespace vp::bench
