// Recording and replay of the calls that change a world.
//
// A Recorder writes each call that changes a world and, after steps, a hash of the complete state.
// A Replay repeats the calls, with any compiler and on any machine, and reports the first step
// after which the state differs. Use recordings to reproduce bugs, to compare two versions of the
// engine, and for demonstrations.
//
//   auto recorder = std::make_shared<vp::Recorder>();
//   (void)world.record(recorder);               // best before anything is created
//   ... create, set, step ...
//   (void)world.record(nullptr);
//   save(recorder->bytes());
//
//   auto replay = vp::Replay::open(load());
//   while (replay && replay->step() == vp::ReplayState::same) draw(replay->world());
//
// A recording that began with an empty world creates its world itself. One that began later
// contains a snapshot. Its replay requires a world made by the same calls, as World::restore does.
//
// Failed calls change nothing and are not recorded, nor are queries. user_data is recorded. A
// recording belongs to one version of the engine: after a change of results the replay reports a
// difference. Format and reasons: docs/decisions/0024.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "vphysics/error.h"
#include "vphysics/world.h"

namespace vp {

struct RecordedCall;

// Objects that a recording refers to by index and does not contain: shapes that are built from
// points or parts, and objects of the user's classes. Each list is in the order of use. A replay
// requires the same objects, made by the same code as in the recorded program.
struct RecordedParts {
  std::vector<Shape> shapes;  // convex hulls, meshes, height fields, compounds
  std::vector<std::shared_ptr<const UserJoint>> joints;
  std::vector<std::shared_ptr<const PairConstraint>> constraints;
};

// Records one world, once: World::record. Other threads must not access it during the recording.
class Recorder {
 public:
  // Takes a hash of the state after every n-th step; 0: none. The first difference is then known to
  // within n steps. A hash reads all the state that a snapshot contains.
  explicit Recorder(std::uint32_t hash_every = 1) : hash_every_(hash_every) {}

  // All recorded bytes that have not been taken. They end after a step, or with the recording.
  std::span<const std::byte> bytes() const { return bytes_; }
  // Moves the bytes out, to append them to a file while the world continues. If the program
  // crashes, such a file can be replayed up to its last complete step.
  std::vector<std::byte> take();
  const RecordedParts& parts() const { return parts_; }
  std::uint64_t steps() const { return steps_; }

 private:
  friend class World;
  [[nodiscard]] Expected<void> begin(const World& world, const WorldDesc& desc,
                                     std::uint64_t topology_hash, bool empty);
  void add(const RecordedCall& call, std::uint64_t topology_hash);
  void add_step(const World& world, double dt);
  void end();
  void write_frame();

  std::vector<std::byte> bytes_, frame_;
  RecordedParts parts_;
  std::uint64_t steps_ = 0;
  double dt_ = 0.0;  // of the last step
  std::uint32_t hash_every_;
  bool begun_ = false;
};

enum class ReplayState : std::uint8_t {
  same,       // made a step; no difference so far
  differs,    // made a step; the state differs, since this step or an earlier one
  end,        // the recording has ended
  cut_short,  // the bytes end after a complete step, but without the recording's end
};

class Replay {
 public:
  // For a recording that began with an empty world. Errc::bad_data: the bytes do not begin as a
  // recording of this version. Errc::invalid_argument: the recording began later.
  [[nodiscard]] static Expected<Replay> open(std::vector<std::byte> bytes,
                                             RecordedParts parts = {});
  // For a recording that began later, with a world made by the same calls. The same errors.
  [[nodiscard]] static Expected<Replay> open(std::vector<std::byte> bytes, RecordedParts parts,
                                             World built);

  // Makes the calls up to the next step, and that step. A replay may continue after a difference.
  // Errc::bad_data, also for all later calls: damaged bytes, of which no call is made; a call that
  // the world rejects; parts that differ from those recorded.
  [[nodiscard]] Expected<ReplayState> step();

  // For inspection. If the caller changes this world, later steps differ.
  World& world() { return world_; }
  const World& world() const { return world_; }
  std::uint64_t steps() const { return steps_; }  // made so far
  // The step, counted from 1, after which a hash first differed.
  std::optional<std::uint64_t> first_difference() const { return first_difference_; }

 private:
  Replay(std::vector<std::byte> bytes, RecordedParts parts, World world)
      : bytes_(std::move(bytes)), parts_(std::move(parts)), world_(std::move(world)) {}
  [[nodiscard]] static Expected<Replay> begin(std::vector<std::byte> bytes, RecordedParts parts,
                                              World* built);
  class Frame;
  [[nodiscard]] Expected<void> play(std::span<const std::byte> frame);
  [[nodiscard]] Expected<void> make(const RecordedCall& call, std::uint64_t topology_hash);
  [[nodiscard]] Expected<void> make_step(double dt, const std::uint64_t* hash);
  tl::unexpected<Error> stop(const Error& error);

  std::vector<std::byte> bytes_;
  RecordedParts parts_;
  World world_;
  std::size_t at_ = 0;
  std::uint64_t steps_ = 0;
  double dt_ = 0.0;
  bool ended_ = false;
  std::optional<std::uint64_t> first_difference_;
  std::optional<Error> error_;
};

}  // namespace vp
