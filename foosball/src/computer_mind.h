// A computer player of a level: decides which rods its two hands hold and where each guards.
// Everything is in the team's frame (computer_sight.h).
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

  // Call before the first play(), and when the characters on the table change.
  void set_table(Layout layout, const TeamBodies& bodies);
  // One tick of play: moves the axes of the rods that the hands hold.
  // own_serve: the team serves next, or served last.
  // forecast: of the current ball, if one is available that is better than the own estimate.
  void play(const Sighting& seen, const Tuning& tuning, bool own_serve,
            const std::optional<BallGuess>& forecast = {});
  // The lines that its hands may hold from now on, as bits; initially all. The other rods belong to
  // a team mate: it knows only what it sees of them.
  void keep_to(std::uint8_t lines);
  bool may_hold(int line) const { return (lines_ >> line & 1) != 0; }
  // The hands leave the rods as they are: another screen is shown.
  void rest();
  bool holds(int line) const { return hands_.holds(line); }
  std::vector<ComputerRod>& rods() { return rods_; }  // by Line
  // The pass that its foot made in this tick; to_rod < 0: none.
  const PlayedPass& passed() const { return passed_; }

 private:
  using Lines = std::array<int, 2>;  // the more urgent first

  bool is_fresh_serve(const Sighting& now);
  void note_strokes(const Sighting& now);
  void guess_ball(Sighting& now, const Tuning& tuning, const std::optional<BallGuess>& forecast);
  Lines target_lines(const Sighting& now) const;
  Lines controlled_lines(const Lines& target) const;
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
  BallGuess sent_;       // the ball as its stroke has just sent it off, not yet seen
  int sent_ticks_ = -1;  // ticks since then; -1: the view is newer
  std::vector<ComputerRod> rods_;
  PlayedPass passed_;
  double side_ = 1.0;  // side of the goal mouth that the defence covers
  bool fresh_serve_ = false;
  bool was_in_play_ = false;
  bool own_serve_ = false;
};

}  // namespace foosball
