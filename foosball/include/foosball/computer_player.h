// A computer player: sees what a person sees, moves the rods of one team with a hand's speed
// limits. Deterministic: its state and seed are its own; one call a tick.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "foosball/match.h"

namespace foosball {

struct ComputerPlayerDesc {
  int team = 1;
  std::uint64_t seed = 1;
  bool opens_match = true;  // pushes at the logo; false: leaves that to a person
  double skill = 0.6;       // 0 sleepy .. 1 sharp: reaction time, aim, hand speed
};

class ComputerPlayer {
 public:
  explicit ComputerPlayer(const ComputerPlayerDesc& desc);
  ~ComputerPlayer();
  ComputerPlayer(ComputerPlayer&&) noexcept;
  ComputerPlayer& operator=(ComputerPlayer&&) noexcept;

  // Targets for the rods of its team; the others are left as they are. Works the screens too:
  // pushes at the logo, chooses and confirms a character.
  void play(const MatchView& view, RodTargets& targets);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace foosball
