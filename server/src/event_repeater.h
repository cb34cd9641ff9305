// Repeats the match's events in snapshots: each gets an id and appears in 8 consecutive snapshots,
// so that it survives the loss of seven datagrams in a row.
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

  // Adds a tick's events. If more than wire::kMaxEvents are active, hits are dropped in favour of
  // events that decide the match. Dropped events are counted.
  void add(std::span<const foosball::Event> events);
  // The events of this snapshot, oldest first.
  void fill(std::vector<wire::EventSnapshot>& out);

  std::uint64_t dropped() const { return dropped_; }

 private:
  struct Slot {
    wire::EventSnapshot event;
    int left = 0;  // remaining snapshots; 0: free slot
  };
  Slot* place_for(foosball::EventKind kind);

  std::array<Slot, wire::kMaxEvents> slots_;
  std::uint32_t last_id_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace server
