// Recording and replay: what was done to a world, so that it can be done again and compared.
//
// A Recorder notes each call that changes a world, and at steps a hash of the whole state. A Replay
// does the calls again, with any compiler and on any machine, and says at which step the state
// first is another. So a recording is a bug that can be sent, a referee for a change of the engine,
// and a demonstration.
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
// A recording that began with an empty world makes its world itself. One that began later carries a
// snapshot, and wants a world made by the same calls, as World::restore does.
//
// Calls that were refused changed nothing and are left out; queries are none. user_data is
// recorded. Recordings are of one version of the engine: after a change of results they differ,
// which is what they are for. Format and reasons: docs/decisions/0024.
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

// What a recording names by number and does not carry: shapes that are built of points or parts,
// and objects of the user's classes. Each is a list in the order of its use; a replay is handed the
// same again, as the program that was recorded makes them.
struct RecordedParts {
  std::vector<Shape> shapes;  // convex hulls, meshes, height fields, compounds
  std::vector<std::shared_ptr<const UserJoint>> joints;
  std::vector<std::shared_ptr<const PairConstraint>> constraints;
};

// Records one world, once: World::record. Not to be touched by another thread meanwhile.
class Recorder {
 public:
  // A hash of the state after every n-th step; 0: none. The first difference is then known within n
  // steps. A hash reads all that a snapshot would hold.
  explicit Recorder(std::uint32_t hash_every = 1) : hash_every_(hash_every) {}

  // All that is recorded and not taken yet. It ends after a step, or with the recording.
  std::span<const std::byte> bytes() const { return bytes_; }
  // Moves it out, to be appended to a file as the world goes on. What a crash leaves of such a file
  // can be replayed up to its last whole step.
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
  same,       // a step was made, and no state was found to be another so far
  differs,    // a step was made, and at it or before the state was another than that recorded
  end,        // the recording is over
  cut_short,  // its bytes stop after a whole step, but not with the recording's end
};

class Replay {
 public:
  // Of a recording that began with an empty world. Refused with Errc::bad_data: bytes that do not
  // begin as a recording of this version; with Errc::invalid_argument: one that began later.
  [[nodiscard]] static Expected<Replay> open(std::vector<std::byte> bytes,
                                             RecordedParts parts = {});
  // Of one that began later, with a world made by the same calls. Refused alike.
  [[nodiscard]] static Expected<Replay> open(std::vector<std::byte> bytes, RecordedParts parts,
                                             World built);

  // The calls up to the next step, and that step. It may go on after a difference. Refused with
  // Errc::bad_data, and from then on for good: damaged bytes, of which nothing is done; a call that
  // the world refuses; parts that are not those recorded.
  [[nodiscard]] Expected<ReplayState> step();

  // To look at; whoever changes it makes the steps that follow differ.
  World& world() { return world_; }
  const World& world() const { return world_; }
  std::uint64_t steps() const { return steps_; }  // made so far
  // The step, counted from 1, after which a hash was first found to be another.
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
