// The stages of a step, for whoever wants to know how long each takes. The engine reads no clock:
// who watches does.
#pragma once

#include <array>
#include <cstdint>

namespace vp {

// In the order of a step. A world without a need of one leaves it out.
enum class Stage : std::uint8_t {
  prepare,       // lists of what is awake, its rows of the solver, its enlarged bounds
  broad_phase,   // pairs of bounds that have come to meet, and those that have parted
  narrow_phase,  // manifolds of those pairs that have moved by more than a little
  lanes,         // these manifolds into the lanes and colours of the solver, or out of them
  sub_steps,     // forces, bounces, joints and contacts of the solver of sub-steps
  report,        // its contact events
  forces,        // what is moved by the stage of impacts, articulations too, feels forces
  impacts,       // continuous bodies and links, in the order of time: bounds, pairs, contacts,
                 // solves with the articulations' joints, impacts, poses; and their events
  advance,       // poses, where there is no stage of impacts
  sleep,         // who rests, and who falls asleep with it
};
inline constexpr std::array kStages{
    Stage::prepare, Stage::broad_phase, Stage::narrow_phase, Stage::lanes,   Stage::sub_steps,
    Stage::report,  Stage::forces,      Stage::impacts,      Stage::advance, Stage::sleep};
const char* name_of(Stage stage);  // "broad phase"

// Told of each stage on the thread that calls step(), outside of all jobs. Stages do not overlap,
// and come once a step, in order; but narrow_phase and lanes alternate where many contacts are
// looked at, some hundred at a time, and once more for each round of sleepers that what they have
// found wakes. Must not change the world (a step within the step is refused), nor throw.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void begin(Stage stage) = 0;
  virtual void end(Stage stage) = 0;
};

// Adds up how long each stage takes.
class StageClock final : public StageObserver {
 public:
  using Now = std::int64_t (*)();  // [ns], of any clock
  explicit StageClock(Now now) : now_(now) {}

  void begin(Stage stage) override;
  void end(Stage stage) override;
  // Since it was made or cleared [ns].
  std::int64_t total(Stage stage) const { return total_[static_cast<std::size_t>(stage)]; }
  void clear() { total_ = {}; }

 private:
  Now now_;
  std::int64_t begun_ = 0;
  std::array<std::int64_t, kStages.size()> total_{};
};

}  // namespace vp
