// Predicts the current state of the ball by the real simulation: a forward model that compensates
// the player's reaction delay. The player knows its own targets since the delayed view. A separate
// table world advances the ball with them from that view to now. While the ball behaves as
// predicted, this world takes one step per tick of play. When the ball is seen elsewhere, a second
// world starts from the view and catches up by a bounded number of steps per tick of play; until
// then there is no forecast.
//
// The forecast uses only what the player has seen: ball and rods with its delay, and its own
// targets. It does not know what others, opponents and team mates, did since then; their men stay
// where they are expected.
//
// Team frame: see computer_sight.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "computer_guess.h"
#include "computer_sight.h"
#include "foosball/match.h"
#include "foosball/tuning.h"

namespace foosball {

class TableWorld;

class BallForecast {
 public:
  // team: the player's. delay_ticks: of its sight. ticks: maximum number of steps of both worlds
  // together per tick of play; at least 3.
  BallForecast(int team, int delay_ticks, int ticks);
  ~BallForecast();
  BallForecast(BallForecast&&) noexcept;
  BallForecast& operator=(BallForecast&&) noexcept;

  // Call each tick, before see(). If a value changes, it rebuilds the worlds, one part of a world
  // per call (table_world.h). There is no forecast until both are built. Allocates only then.
  void set_table(Layout layout, const TeamBodies& bodies, const Tuning& tuning);
  // Call before the player acts. Precondition: set_table() in this tick.
  void see(const Sighting& seen);
  // The ball now; none while it deviates from the prediction.
  std::optional<BallGuess> ball() const;
  // Call after the player has acted. targets: of this tick, in the table's frame. own: the player's
  // own rods, as bits; it does not read the targets of other rods.
  void act(const RodTargets& targets, std::uint8_t own);
  // Discards the history: play was interrupted.
  void forget();

  // Steps of both worlds since the last see() began.
  int ticks_spent() const { return spent_; }

 private:
  struct Run;

  static constexpr int kWorlds = 2;
  bool is_built() const { return built_ == kWorlds; }
  void build_part();
  void start(Run& run, const Sighting& seen);
  void step(Run& run);
  bool as_expected(const Run& run, const Sighting& seen, double metres, double speed) const;
  std::size_t slot(long tick) const;
  long seen_tick(const Sighting& seen) const;

  int team_, ticks_;
  std::size_t memory_;  // ticks
  Layout layout_ = Layout::tournament;
  TeamBodies bodies_;
  Tuning tuning_;
  std::unique_ptr<Run> now_, catching_up_;  // null until created
  int built_ = 0;                           // number of them built for this table
  bool begun_ = false;                      // the next one is partly built
  std::vector<RodTargets> targets_;  // ring buffer, by tick; live: the rod was the player's own
  Sighting seen_;
  long tick_ = 0;
  int spent_ = 0;
};

}  // namespace foosball
