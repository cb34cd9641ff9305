// The interface of an engine in the comparison, ours or a peer.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "models.h"
#include "states.h"

namespace vp::bench {

enum class Metric { forward, inverse, mass };
inline constexpr Metric kMetrics[] = {Metric::forward, Metric::inverse, Metric::mass};
const char* name_of(Metric metric);

inline constexpr Vec3 kGravity{0, 0, -9.81};

// A model with its states, in the engine's own format. All data are converted at construction, so
// that a call costs as much as for a user of that engine.
class Engine {
 public:
  virtual ~Engine() = default;
  // Why the engine has no such call; empty if it has one.
  virtual std::string lacks(Metric) const { return {}; }
  // Sets the state and computes the metric; only this is timed. No result is cached between calls.
  // Returns a number of the result, so that the compiler cannot remove the call.
  virtual double call(Metric metric, std::size_t state) = 0;
  // The same. Returns the complete result in our convention: accelerations, forces, or the matrix
  // by rows.
  virtual std::vector<double> result(Metric metric, std::size_t state) = 0;
};

// The engine, or why it does not support this model.
using MadeEngine = tl::expected<std::unique_ptr<Engine>, std::string>;
MadeEngine make_ours(const BenchModel& model, const std::vector<State>& states);
MadeEngine make_mujoco(const BenchModel& model, const std::vector<State>& states);
MadeEngine make_dart(const BenchModel& model, const std::vector<State>& states);
MadeEngine make_kdl(const BenchModel& model, const std::vector<State>& states);
MadeEngine make_bullet(const BenchModel& model, const std::vector<State>& states);
MadeEngine make_simbody(const BenchModel& model, const std::vector<State>& states);

struct EngineKind {
  const char* option;  // on the command line
  const char* name;    // in tables
  MadeEngine (*make)(const BenchModel&, const std::vector<State>&);
};
inline constexpr EngineKind kEngines[] = {
    {"vphysics", "Virtual Physics", make_ours},
    {"mujoco", "MuJoCo", make_mujoco},
    {"dart", "DART", make_dart},
    {"kdl", "KDL", make_kdl},
    {"bullet", "Bullet", make_bullet},
    {"simbody", "Simbody", make_simbody},
};

// Measured for packs of states: forward dynamics, and the derivatives of both dynamics.
enum class BatchCall { forward, forward_derivatives, inverse_derivatives };

// Virtual Physics on several states at once, or on one for calls that the peers do not have.
class Batch {
 public:
  virtual ~Batch() = default;
  virtual std::string name() const = 0;  // "double4"
  virtual int lanes() const = 0;
  virtual bool single() const = 0;  // single precision
  virtual std::size_t packs() const = 0;
  // Computes all states of a pack.
  virtual double call(BatchCall call, std::size_t pack) = 0;
  // Accelerations, or the derivatives by q, by v, and by a or tau, each by rows.
  virtual std::vector<double> result(BatchCall call, std::size_t pack, int lane) = 0;
};
// Lane l of pack p has the state p * lanes + l. The first batch has one lane of double.
// Precondition: the number of states is a multiple of 16.
std::vector<std::unique_ptr<Batch>> make_batches(const BenchModel& model,
                                                 const std::vector<State>& states);
// Derivatives are measured up to this many velocities. The matrices of longer chains exceed the
// caches, and finally the memory.
inline constexpr int kMostVelocitiesDifferentiated = 128;

}  // namespace vp::bench
