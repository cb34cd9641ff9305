// Times of impact of swept pairs within a step, earliest first.
//
// A pair holds until the motion of one of its bodies changes: then all pairs of that body are
// forgotten, and found again by whoever changed it. So an impact costs what its bodies' pairs cost.
//
// What a body may meet after its first impact, it most likely does not meet: such a pair waits in
// the queue, at the time of that impact, until its own time is wanted.
#pragma once

#include <cstdint>
#include <vector>

#include "world/impact_pairs.h"

namespace vp {

// A time of impact. What stands at `from` moves on for exactly `after`.
struct Instant {
  double time = 0.0;  // within the step [s]
  double from = 0.0, after = 0.0;

  double since(double earlier) const { return earlier == from ? after : time - earlier; }
};

struct QueuedPair {
  SweptPair swept;
  std::uint32_t a, b;                // bodies
  std::uint32_t motion_a, motion_b;  // of the bodies' motions those that it was found with
  double found = 0.0;                // when [s]
  double after = 0.0;                // the impact follows; of a pair that waits, no earlier
};

class ImpactQueue {
 public:
  // In the order in which they come at one time.
  enum class Kind : std::uint8_t { sensor, impact, waiting };
  struct Entry {
    double time;
    Kind kind;
    std::uint64_t key;
    std::uint32_t pair;
  };

  void reserve(std::size_t pairs);
  // At the start of a step: of so many bodies.
  void clear(std::size_t bodies);
  // The body's motion has changed.
  void forget_pairs_of(std::uint32_t body) { ++motions_[body]; }
  std::uint32_t add(QueuedPair pair);
  // Precondition: the pair has found and after.
  void wait(std::uint32_t pair, Kind kind);
  // The first of a pair that holds, or null. Valid until the next call.
  const Entry* first();
  void pop();
  QueuedPair& pair(std::uint32_t index) { return pairs_[index]; }

 private:
  bool holds(const QueuedPair& pair) const {
    return motions_[pair.a] == pair.motion_a && motions_[pair.b] == pair.motion_b;
  }

  std::vector<QueuedPair> pairs_;  // of the step, also those that hold no longer
  std::vector<Entry> heap_;
  std::vector<std::uint32_t> motions_;  // of each body: how often its motion has changed
};

}  // namespace vp
