// Islands: bodies connected by contacts and joints. They fall asleep together and wake together.
//
// A body becomes a sleep candidate when it has been slow for sleep_after. At that time, and after
// each further sleep_after, its whole island is searched. The island falls asleep if all its bodies
// are candidates. If not, the searched bodies stay candidates and wait for another sleep_after. So
// each body is searched about once in that time, and the last body that becomes a candidate finds
// the others ready.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "world/contact_store.h"
#include "world/joint.h"

namespace vp {

// The connections between bodies.
struct IslandGraph {
  Bodies& bodies;
  const Colliders& colliders;
  ContactStore& contacts;
  const Joints& joints;
};

class SleepIslands {
 public:
  void reserve(std::size_t bodies);
  // Updates the time for which a body has been slow, at the end of a step.
  void watch(Body& body, std::uint32_t index, const WorldDesc& desc, double dt);
  // Calls f(island) for each island at rest, of all bodies watched since the last call. f puts it
  // to sleep.
  template <class F>
  void find_resting(const IslandGraph& graph, double sleep_after, const F& f) {
    const std::uint64_t first = found_ + 1;
    for (const std::uint32_t seed : candidates_) {
      if (graph.bodies[seed].island >= first) continue;  // asleep, or searched without success
      if (rests(graph, seed, first, sleep_after)) f(std::span<const std::uint32_t>(island_));
    }
    candidates_.clear();
  }
  // Wakes a sleeping body and its island. Returns all bodies that it woke.
  std::span<const std::uint32_t> wake(const IslandGraph& graph, std::uint32_t body);

 private:
  bool rests(const IslandGraph& graph, std::uint32_t seed, std::uint64_t first, double sleep_after);

  std::uint64_t found_ = 0;
  std::vector<std::uint32_t> candidates_;  // bodies whose islands are searched in this step
  std::vector<std::uint32_t> island_, woken_;
};

}  // namespace vp
