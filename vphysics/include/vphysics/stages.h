// The stages of a step, for profiling. The engine reads no clock: the observer does.
#pragma once

#include <array>
#include <cstdint>

namespace vp {

// In the order of a step. A world skips the stages that it does not need.
enum class Stage : std::uint8_t {
  // Lists of awake bodies, their state in the solver, their enlarged AABBs.
  prepare,
  // Pairs of AABBs that have begun to overlap, and those that have separated.
  broad_phase,
  // Manifolds of the pairs that have moved by more than a small distance.
  narrow_phase,
  // Adds these manifolds to the contact slots and colours of the solver, or removes them.
  contact_slots,
  // Forces, restitution, joints and contacts of the sub-stepped solver.
  sub_steps,
  // Contact events of the sub-steps.
  report,
  // Forces on continuous bodies and articulations, which the impact stage moves.
  forces,
  // Continuous bodies and links, in the order of time: AABBs, pairs, contacts, solves together with
  // the joints of articulations, impacts, poses; and their events.
  impacts,
  // Poses, in worlds without the impact stage.
  advance,
  // Finds islands at rest and puts them to sleep.
  sleep,
};
inline constexpr std::array kStages{
    Stage::prepare, Stage::broad_phase, Stage::narrow_phase, Stage::contact_slots, Stage::sub_steps,
    Stage::report,  Stage::forces,      Stage::impacts,      Stage::advance,       Stage::sleep};
const char* name_of(Stage stage);  // "broad phase"

// Called for each stage on the thread that calls step(), outside of all tasks. Stages do not
// overlap and run once a step, in order, with one exception: narrow_phase and contact_slots
// alternate, some hundred contacts at a time, and once more each time that contacts wake sleeping
// bodies. The observer must not change the world (a step within the step fails), nor throw.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void begin(Stage stage) = 0;
  virtual void end(Stage stage) = 0;
};

// Accumulates the time of each stage.
class StageClock final : public StageObserver {
 public:
  using Now = std::int64_t (*)();  // [ns], of any clock
  explicit StageClock(Now now) : now_(now) {}

  void begin(Stage stage) override;
  void end(Stage stage) override;
  // Since construction or clear() [ns].
  std::int64_t total(Stage stage) const { return total_[static_cast<std::size_t>(stage)]; }
  void clear() { total_ = {}; }

 private:
  Now now_;
  std::int64_t begun_ = 0;
  std::array<std::int64_t, kStages.size()> total_{};
};

}  // namespace vp
