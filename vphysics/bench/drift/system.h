// The systems whose energy and momentum are watched, and what an engine must do with them.
//
// Whatever moves a system tells its state as Virtual Physics has it, so that energy and momentum
// are computed by one code for all of them.
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
  double energy_scale;    // [J] by which errors of energy are divided
  double momentum_scale;  // [N m s] of angular momentum; 0: it is not kept
};

// A body with moments of inertia 0.2, 0.35 and 0.5 kg m^2, free, without gravity, turning at 3
// rad/s mostly about the middle axis, hence tumbling.
System tumbling_body();
// Ten rods of 0.2 m and 1 kg on parallel hinges, let go from a horizontal line. Chaotic: of its
// motion only the energy can be compared.
System ten_link_pendulum();

// One engine and one of its integrators with a system.
class Mover {
 public:
  virtual ~Mover() = default;
  virtual void advance(int steps) = 0;  // of kStep
  virtual State state() const = 0;
  bool failed = false;  // the integrator gave up: no more is to be had of it

  std::string name;  // "engine: integrator"
};

std::vector<std::unique_ptr<Mover>> our_movers(const System& system);
std::vector<std::unique_ptr<Mover>> mujoco_movers(const System& system);
std::vector<std::unique_ptr<Mover>> dart_movers(const System& system);

}  // namespace vp::bench
