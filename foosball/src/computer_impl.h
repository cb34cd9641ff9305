// The kinds of computer players behind ComputerPlayer.
#pragma once

#include <memory>

#include "foosball/computer_player.h"

namespace foosball {

struct ComputerPlayer::Impl {
  virtual ~Impl() = default;
  virtual void play(const MatchView& view, RodTargets& targets) = 0;
  virtual PlayedPass passed() const { return {}; }
};

std::unique_ptr<ComputerPlayer::Impl> make_classic_player(const ComputerPlayerDesc& desc);
std::unique_ptr<ComputerPlayer::Impl> make_level_player(const ComputerPlayerDesc& desc);

}  // namespace foosball
