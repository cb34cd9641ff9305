// Both teams' hands on a cabinet's rods. In play they follow the computer players' targets as fast
// as a hand can. Between balls they do what people do who know that counts drift.
#pragma once

#include <optional>
#include <vector>

#include "foosball/computer_player.h"
#include "foosball/rod_motion.h"
#include "match_run.h"

namespace cabinet_bench {

inline constexpr foosball::Layout kLayout = foosball::Layout::tournament;

// Advances a rod of the match by one tick, as a hand drives it.
foosball::RodState step_rod(const foosball::MatchView& view, std::size_t rod,
                            const foosball::RodState& now, const foosball::RodTarget& target);

class Hands {
 public:
  Hands(const MatchOptions& options, const PerRod<Pose>& begin);

  PerRod<Pose> move(const foosball::MatchView& view);
  const foosball::RodState& rod(std::size_t i) const { return rods_[i]; }

 private:
  foosball::RodTarget target(std::size_t rod);
  void begin_swing(const foosball::MatchView& view);

  bool swings_;
  std::vector<foosball::ComputerPlayer> players_;
  foosball::RodTargets targets_{};  // of the players
  std::array<foosball::RodState, foosball::kRods> rods_{};
  std::optional<foosball::Screen> screen_;
  double swing_seconds_;  // since the swing began
  PerRod<Pose> swing_from_{};
};

}  // namespace cabinet_bench
