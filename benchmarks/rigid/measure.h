// Runs scenes with engines, in turns, and keeps what each did.
//
// All engines of a scene at a rate run beside each other, each in its process, one at a time: a
// quarter of a second of the scene's time each, again and again. So what slows the machine for a
// while slows all of them, at the same moment of the scene. What goals are set against each other
// is run several times: of each step the least counts, since neighbours on a shared machine slow
// one engine by another share than the next.
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
  const char* program;  // of the folder of programs; of node: its first argument
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
// And, with more behind it, our other builds.
inline constexpr const char* kOurs = kEngines[0].name;
// Whose times goals are shares of.
inline constexpr const char* kReference = kEngines[1].name;

struct Plan {
  std::vector<std::string> scenes;
  std::vector<int> rates;            // [Hz]
  std::vector<std::string> engines;  // options of kEngines
  // Of processor time for a peer's run, at most; at 60 Hz, where runs are to reach their end, more.
  // Ours has six times that.
  double seconds = 10.0, seconds_at_60 = 30.0;
  // At 60 Hz, if both come to their end within this processor time [s], Virtual Physics and Bullet
  // are run so often.
  int runs = 3;
  double repeated_within = 60.0;
  // By the clock: how long the programs may take to answer, beyond ten times that. Others run too.
  double patience = 120.0;
  std::string programs{};               // folder of the native engines' programs
  std::string scripts{};                // folder of run.mjs and wasi.mjs; node's packages are in it
  std::string wasm{};                   // folder of rigid-ours.wasm
  std::string log = "/dev/null";        // what the programs complain of
  std::set<std::string> at_60_alone{};  // scenes that are not run at higher rates
  // By an engine's name: why it is not run, at all or on scenes with joints.
  std::map<std::string, std::string> left_out{}, left_out_of_joints{};
};

// Of an engine, one scene at one rate.
struct Figure {
  std::string scene, engine;
  int rate = 0;
  std::string missing{};  // why there is none; empty: there are figures
  std::string settings{};
  std::string ended{};      // finished, budget, or stopped: and why
  double simulated = 0.0;   // of the scene's seconds [s]
  double median_us = 0.0;   // of least_us where there are several runs
  double p99_us = 0.0;      // of the first run
  double settled_us = 0.0;  // as median_us, of the last quarter of a finished run; else 0
  double rss_mb = 0.0;
  double fastest = -1.0;  // body's displacement in the last step by its time [m/s]; < 0: not known
  bool bits_as_native = false;  // its poses are those of the native program
  scenes::Standing standing{};  // where it ended
  int runs = 1;
  std::vector<double> steps_us{};  // of each step but the first of each turn, in the first run
  std::vector<double> least_us{};  // the same, of all runs; empty if there is only one
  std::vector<vp::SE3> poses{};    // the same

  bool stopped() const { return ended.starts_with("stopped"); }
};

// The median step of a as a share of b's, over the steps that both have made: at the same moments
// of the scene, of as many runs. 0: there are none.
double share(const Figure& a, const Figure& b);

// In the order of the plan. said: told what is being done.
std::vector<Figure> measure(const Plan& plan, const std::function<void(const std::string&)>& said);

}  // namespace rigid
