// Events of the match on their way into snapshots: each gets an id and is in 8 snapshots one after
// the other, so that seven lost datagrams in a row still show it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "foosball/match.h"
#include "wire/snapshot.h"

namespace server {

wire::EventSnapshot to_wire(const foosball::Event& event, std::uint32_t id);

class EventRepeater {
 public:
  static constexpr int kRepeats = 8;

  // Takes in a tick's events. Where more than wire::kMaxEvents are under way at a time, a hit gives
  // way to what decides the match; what found no place, or lost it, is counted.
  void add(std::span<const foosball::Event> events);
  // Those of this snapshot, oldest first.
  void fill(std::vector<wire::EventSnapshot>& out);

  std::uint64_t dropped() const { return dropped_; }

 private:
  struct Slot {
    wire::EventSnapshot event;
    int left = 0;  // snapshots still to be in; 0: free
  };
  Slot* place_for(foosball::EventKind kind);

  std::array<Slot, wire::kMaxEvents> slots_;
  std::uint32_t last_id_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace server
