// Converts the hits of a tick, in the same tick, to bounded pulses (cabinet/haptics.h) for the
// drivers of the rods: the cabinet's controller and phones. Clients with a screen use the events of
// their snapshots instead. Never blocks, never allocates.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "cabinet/haptics.h"
#include "foosball/match.h"
#include "rod_desk.h"

namespace server {

class HapticDesk {
 public:
  // Sends to the client, of any kind.
  using ToClient = std::function<void(std::uint32_t client, const cabinet::HapticPulse& pulse)>;

  explicit HapticDesk(bool on) : on_(on) {}
  void to_cabinet(cabinet::HapticSink* sink) { cabinet_ = sink; }  // null: it has no motors
  void to_clients(ToClient send) { clients_ = std::move(send); }

  void feel(std::span<const foosball::Event> events, const foosball::MatchView& view,
            const RodDesk& desk, std::int64_t now_us);
  std::uint64_t pulses() const { return pulses_; }  // for rods that a hand has

 private:
  bool on_;
  cabinet::HapticSink* cabinet_ = nullptr;
  ToClient clients_;
  cabinet::HapticLimiter limiter_;
  std::uint64_t pulses_ = 0;
};

}  // namespace server
