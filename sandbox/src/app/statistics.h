// Summary of a run, for the terminal and as JSON.
#pragma once

#include <cstdint>
#include <string>

#include "core/simulation.h"
#include "scenes/measure.h"

namespace sandbox {

struct Statistics {
  std::string scene;
  int rate = 0;
  double seconds = 0.0;  // of scene time
  std::size_t steps = 0;
  StepTimes::Statistics step;  // [us]
  scenes::Standing standing;
  std::uint64_t hash = 0;  // of the world's state
  int frames = 0;          // drawn
  double frames_per_second = 0.0;
};

// Of the simulation's present state; without the frames.
Statistics statistics_of(const Simulation& simulation);
std::string sentence(const Statistics& statistics);
std::string json(const Statistics& statistics);

}  // namespace sandbox
