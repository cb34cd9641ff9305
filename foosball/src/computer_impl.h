// The implementations behind ComputerPlayer.
#pragma once

#include <cstdint>
#include <memory>

#include "foosball/computer_player.h"

namespace foosball {

inline constexpr std::uint8_t kAllLines = 0xF;
// The team's lines among the rods, as bits.
std::uint8_t lines_of(Layout layout, int team, std::uint8_t rods);

struct ComputerPlayer::Impl {
  virtual ~Impl() = default;
  virtual void play(const MatchView& view, RodTargets& targets, std::uint8_t rods) = 0;
  virtual PlayedPass passed() const { return {}; }
};

std::unique_ptr<ComputerPlayer::Impl> make_classic_player(const ComputerPlayerDesc& desc);
std::unique_ptr<ComputerPlayer::Impl> make_level_player(const ComputerPlayerDesc& desc);

}  // namespace foosball
