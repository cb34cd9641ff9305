// Times of impact of swept pairs within a step, earliest first.
//
// A pair is valid until the motion of one of its bodies changes. Then forget_pairs_of() invalidates
// all pairs of that body, and the caller finds them again. So the cost of an impact depends only on
// the pairs of its bodies.
//
// A pair that does not collide before the first impact of one of its bodies is unlikely to collide
// at all. It waits in the queue at the time of that impact. Its own time of impact is computed only
// when it reaches the front.
#pragma once

#include <cstdint>
#include <vector>

#include "world/impact_pairs.h"

namespace vp {

// A time of impact. A body whose pose is at time `from` advances by exactly `after`, which avoids
// the rounding of time - from.
struct Instant {
  double time = 0.0;  // within the step [s]
  double from = 0.0, after = 0.0;

  double since(double earlier) const { return earlier == from ? after : time - earlier; }
};

struct QueuedPair {
  SweptPair swept;
  std::uint32_t a, b;                // bodies
  std::uint32_t motion_a, motion_b;  // the bodies' motion counts when the pair was found
  double found = 0.0;                // time at which it was found [s]
  double after = 0.0;  // time from then to the impact [s]; a lower bound if the pair waits
};

class ImpactQueue {
 public:
  // In the order in which entries of equal time are processed.
  enum class Kind : std::uint8_t { sensor, impact, waiting };
  struct Entry {
    double time;
    Kind kind;
    std::uint64_t key;
    std::uint32_t pair;
  };

  void reserve(std::size_t pairs);
  // Call at the start of a step. bodies: their number.
  void clear(std::size_t bodies);
  // Call after a change of the body's motion.
  void forget_pairs_of(std::uint32_t body) { ++motions_[body]; }
  std::uint32_t add(QueuedPair pair);
  // Queues a pair of add(). Precondition: its found and after are set.
  void wait(std::uint32_t pair, Kind kind);
  // The first entry whose pair is valid, or null. Valid until the next call.
  const Entry* first();
  void pop();
  QueuedPair& pair(std::uint32_t index) { return pairs_[index]; }

 private:
  bool holds(const QueuedPair& pair) const {
    return motions_[pair.a] == pair.motion_a && motions_[pair.b] == pair.motion_b;
  }

  std::vector<QueuedPair> pairs_;  // of the step, including invalid ones
  std::vector<Entry> heap_;
  std::vector<std::uint32_t> motions_;  // motion count of each body: changes within the step
};

}  // namespace vp
