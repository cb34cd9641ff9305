// Runs scenes with engines, in turns, and stores the results.
//
// For each scene and rate, every engine has a process of its own. The engines take turns of a
// quarter of a second of simulated time; only one runs at a time. So a temporary slowdown of the
// machine affects all of them, at the same time of the scene. Engines that goals compare run
// several times, and the minimum time of each step counts: other load on a shared machine slows
// engines by different amounts.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "scenes/measure.h"

namespace rigid {

struct EngineKind {
  const char* option;   // on the command line
  const char* name;     // in tables
  const char* program;  // file in the folder of programs; with node, its first argument
  bool node;
};
inline constexpr EngineKind kEngines[] = {
    {"vphysics", "Virtual Physics", "rigid-ours", false},
    {"bullet", "Bullet", "rigid-bullet", false},
    {"ode", "ODE", "rigid-ode", false},
    {"mujoco", "MuJoCo", "rigid-mujoco", false},
    {"vphysics-wasm", "Virtual Physics (WebAssembly)", "rigid-ours.wasm", true},
    {"jolt", "Jolt (WebAssembly)", "jolt", true},
    {"rapier", "Rapier (WebAssembly)", "rapier", true},
};
// The names of our other builds begin with it.
inline constexpr const char* kOurs = kEngines[0].name;
// The engine whose times goals refer to.
inline constexpr const char* kReference = kEngines[1].name;

struct Plan {
  std::vector<std::string> scenes;
  std::vector<int> rates;            // [Hz]
  std::vector<std::string> engines;  // options of kEngines
  // Maximum processor time of a peer's run [s]; longer at 60 Hz, where runs should reach the end of
  // the scene. Virtual Physics has six times this.
  double seconds = 10.0, seconds_at_60 = 30.0;
  // The number of runs of Virtual Physics and Bullet at 60 Hz, if both reach the end of the scene
  // within the processor time repeated_within [s].
  int runs = 3;
  double repeated_within = 60.0;
  // Timeout of an answer [s of wall time], in addition to ten times the processor time: other
  // processes run too.
  double patience = 120.0;
  std::string programs{};               // folder of the native engines' programs
  std::string scripts{};                // folder of run.mjs, wasi.mjs and node_modules
  std::string wasm{};                   // folder of rigid-ours.wasm
  std::string log = "/dev/null";        // standard error of the programs
  std::set<std::string> at_60_alone{};  // scenes that are not run at higher rates
  // By an engine's name: why it is not run at all, or not on scenes with joints.
  std::map<std::string, std::string> left_out{}, left_out_of_joints{};
};

// The results of an engine for one scene at one rate.
struct Figure {
  std::string scene, engine;
  int rate = 0;
  std::string missing{};  // why there are no results; empty: there are
  std::string settings{};
  std::string ended{};      // finished, budget, or stopped with the reason
  double simulated = 0.0;   // simulated time [s]
  double median_us = 0.0;   // of min_us if there are several runs
  double p99_us = 0.0;      // of the first run
  double settled_us = 0.0;  // median of the last quarter of a finished run; else 0
  double rss_mb = 0.0;
  double fastest = -1.0;        // max mean speed of a body in the last step [m/s]; < 0: unknown
  bool bits_as_native = false;  // its poses equal those of the native program
  scenes::Standing standing{};  // quality of the final state
  int runs = 1;
  std::vector<double> steps_us{};  // times in the first run, without the first step of each turn
  std::vector<double> min_us{};    // minimum of all runs for each; empty if there is only one run
  std::vector<vp::SE3> poses{};    // final poses of the first run

  bool stopped() const { return ended.starts_with("stopped"); }
};

// The median step time of a divided by that of b, over the steps that both have made: at the same
// times of the scene, from equal numbers of runs. 0: there are no such steps.
double share(const Figure& a, const Figure& b);

// Returns the results in the order of the plan. said: receives progress messages.
std::vector<Figure> measure(const Plan& plan, const std::function<void(const std::string&)>& said);

}  // namespace rigid
