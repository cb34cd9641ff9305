// A computer player of a level: which rods its two hands hold, and where each guards. All in the
// team's frame (computer_sight.h).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "computer_guess.h"
#include "computer_hands.h"
#include "computer_level.h"
#include "computer_rod.h"
#include "computer_sight.h"
#include "foosball/played_pass.h"
#include "random.h"

namespace foosball {

class ComputerMind {
 public:
  ComputerMind(int team, const Temperament& t, std::uint64_t seed);

  // Before the first play(), and when other characters are on the table.
  void set_table(Layout layout, const TeamBodies& bodies);
  // One tick of play: moves the axes of the rods that the hands hold.
  // own_serve: the next serve, or the last, is the own team's.
  // forecast: of the ball now, if there is one better than the mind's own guess.
  void play(const Sighting& seen, const Tuning& tuning, bool own_serve,
            const std::optional<BallGuess>& forecast = {});
  // The lines that its hands may hold, by bit, from now on; at first all. Rods of the others are a
  // team mate's: it knows no more of them than it sees.
  void keep_to(std::uint8_t lines);
  bool may_hold(int line) const { return (lines_ >> line & 1) != 0; }
  // The hands leave the rods as they are: another screen.
  void rest();
  bool holds(int line) const { return hands_.holds(line); }
  std::vector<ComputerRod>& rods() { return rods_; }  // by Line
  // A pass that its foot has sent off in this tick; to_rod < 0: none.
  const PlayedPass& passed() const { return passed_; }

 private:
  using Lines = std::array<int, 2>;  // the more urgent first

  bool is_fresh_serve(const Sighting& now);
  void note_strokes(const Sighting& now);
  void guess_ball(Sighting& now, const Tuning& tuning, const std::optional<BallGuess>& forecast);
  Lines wanted_lines(const Sighting& now) const;
  Lines own_lines(const Lines& wanted) const;
  double guard_y(int line, const Sighting& now) const;
  double cover_y(int line, const Sighting& now) const;
  double beside_mate(int line, const Sighting& now) const;
  double to_goal(int line, const Sighting& now) const;

  int team_;
  Temperament t_;
  Random random_;
  ComputerHands hands_;
  std::uint8_t lines_ = 0xF;
  const TableSpec* table_ = nullptr;
  GuessModel model_;
  BallGuess sent_;       // the ball as a stroke has just sent it off, not yet seen
  int sent_ticks_ = -1;  // since then; -1: what is seen is newer
  std::vector<ComputerRod> rods_;
  PlayedPass passed_;
  double side_ = 1.0;  // of the mouth that the defence covers
  bool fresh_serve_ = false;
  bool was_in_play_ = false;
  bool own_serve_ = false;
};

}  // namespace foosball
