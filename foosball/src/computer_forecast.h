// Where the ball is now, by the real simulation: a forward model that makes up for the player's
// reaction delay. The player remembers what its own hands have done since what it sees now
// happened; a table world of its own carries the ball on from there. While the ball does what was
// expected, that world runs one tick ahead for each tick of play. When the ball is seen elsewhere,
// a second world starts from what was seen and catches up, a bounded number of ticks for each tick
// of play; until then there is no forecast.
//
// Knows no more than the player has seen: ball and rods with its delay, and its own targets. What
// others, opponents and team mates, have done since then it does not know; their men stay where
// they are expected.
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
  // Of the player's team. delay: of its sight. ticks: of both worlds together, the most for one
  // tick of play; at least 3.
  BallForecast(int team, int delay_ticks, int ticks);
  ~BallForecast();
  BallForecast(BallForecast&&) noexcept;
  BallForecast& operator=(BallForecast&&) noexcept;

  // Each tick, before see(). If they differ, the worlds are made anew, a part of one world a call
  // (table_world.h): until both are whole there is no forecast. Takes memory then, and only then.
  void set_table(Layout layout, const TeamBodies& bodies, const Tuning& tuning);
  // Before the player acts. Precondition: set_table() in this tick.
  void see(const Sighting& seen);
  // The ball now; nothing while it does what was not expected.
  std::optional<BallGuess> ball() const;
  // After the player has acted: its targets of this tick, in the table's frame, of the rods that
  // are its own, by bit; those of others are not read.
  void act(const RodTargets& targets, std::uint8_t own);
  // What went before says nothing of what comes: play was interrupted.
  void forget();

  // World ticks since the last see() began, and the most of any tick of play.
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
  std::unique_ptr<Run> now_, catching_up_;  // null until made
  int built_ = 0;                           // of them, of this table
  bool begun_ = false;                      // the next one
  std::vector<RodTargets> targets_;         // by tick, a ring; live: of a rod that was its own
  Sighting seen_;
  long tick_ = 0;
  int spent_ = 0;
};

}  // namespace foosball
