// What the match's rules decide, in words: the clock of possession, whose serve it is, what stopped
// the play, the sets, the way up the ladder. Pure: what was heard in, sentences out.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/hud.h"

namespace client {

// "● ORION".
std::string team_with_mark(int team);

// "4 attack"... in the person's language: of a rod by its line.
std::string line_name(int layout, int rod);

// What is left until the side that has the ball has held it too long.
struct PossessionClock {
  int team = 0;
  int seconds = 0;       // begun ones
  bool hurries = false;  // soon over
};
// By the tournament's rules it is always told, else once it hurries.
std::optional<PossessionClock> possession_clock(const wire::Snapshot& state);

// In play: a time-out, a foul for a while, whose serve it is, that the next goal decides, in
// training the last shot. Empty: nothing.
std::string rules_line(const HudState& hud);

struct CeremonyWords {
  std::string call;    // what stopped the play
  std::string line;    // for whom
  std::string detail;  // by whom, or how the match stands
};
CeremonyWords ceremony_words(const HudState& hud);

struct EndWords {
  std::string title;
  std::array<int, 2> result{};       // by team: sets, where there were several, else goals
  std::vector<std::string> details;  // a line each
  std::string call;                  // what a push leads to
};
// Of each pair of numbers that of team `left` is first.
EndWords end_words(const HudState& hud, std::size_t left);

// On the ladder "Rung 3 of 5" and "level 3, passer", in a challenge what it is and how it stands;
// empty: neither.
std::array<std::string, 2> mode_lines(const wire::Snapshot& state, std::size_t left);

}  // namespace client
