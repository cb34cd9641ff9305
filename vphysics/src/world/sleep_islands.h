// Islands of bodies that hang together by contacts and joints. They fall asleep together, and wake
// together.
//
// A body is a candidate for sleep when it has been slow for sleep_after. As soon as it is, and then
// each sleep_after, it asks: its whole island is searched, and falls asleep if all of it are
// candidates. If not, those that were searched stay candidates, and ask again after as long: so a
// body is searched about once in that time, and the last one that becomes a candidate finds the
// others so.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "world/contact_store.h"
#include "world/joint.h"

namespace vp {

// What holds bodies together.
struct IslandGraph {
  Bodies& bodies;
  const Colliders& colliders;
  ContactStore& contacts;
  const Joints& joints;
};

class SleepIslands {
 public:
  void reserve(std::size_t bodies);
  // Counts for how long a body has been slow, at the end of a step.
  void watch(Body& body, std::uint32_t index, const WorldDesc& desc, double dt);
  // f(island) of each that rests, of all watched since the last time; f puts it to sleep.
  template <class F>
  void find_resting(const IslandGraph& graph, double sleep_after, const F& f) {
    const std::uint64_t first = found_ + 1;
    for (const std::uint32_t seed : candidates_) {
      if (graph.bodies[seed].island >= first) continue;  // asleep, or gone through in vain
      if (rests(graph, seed, first, sleep_after)) f(std::span<const std::uint32_t>(island_));
    }
    candidates_.clear();
  }
  // A body that is asleep wakes with all that it hangs together with. Returns all of these.
  std::span<const std::uint32_t> wake(const IslandGraph& graph, std::uint32_t body);

 private:
  bool rests(const IslandGraph& graph, std::uint32_t seed, std::uint64_t first, double sleep_after);

  std::uint64_t found_ = 0;
  std::vector<std::uint32_t> candidates_;  // bodies that ask in this step
  std::vector<std::uint32_t> island_, woken_;
};

}  // namespace vp
