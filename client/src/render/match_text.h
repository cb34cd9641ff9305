// Text for the decisions of the match's rules: the possession clock, whose serve it is, why the
// play stopped, the sets, the progress on the ladder. Pure: depends only on the given data.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/hud.h"

namespace client {

// "● ORION".
std::string team_with_mark(int team);

// Name of a rod by its line, "4 attack"..., in the person's language.
std::string line_name(int layout, int rod);

// Time until the side that has the ball has held it too long.
struct PossessionClock {
  int team = 0;
  int seconds = 0;       // rounded up
  bool hurries = false;  // soon over
};
// Always shown by the tournament's rules; otherwise once little time is left.
std::optional<PossessionClock> possession_clock(const wire::Snapshot& state);

// In play: a time-out; a foul, for a while; whose serve it is; that the next goal decides; in
// training the last shot. Empty: nothing.
std::string rules_line(const HudState& hud);

struct CeremonyText {
  std::string call;    // why the play stopped
  std::string line;    // which team it is for
  std::string detail;  // who did it, or the state of the match
};
CeremonyText ceremony_text(const HudState& hud);

struct EndText {
  std::string title;
  std::array<int, 2> result{};       // by team: sets if there were several, else goals
  std::vector<std::string> details;  // one line each
  std::string call;                  // what a push starts
};
// In each pair of numbers, the one of team `left` is first.
EndText end_text(const HudState& hud, std::size_t left);

// On the ladder "Rung 3 of 5" and "level 3, passer"; in a challenge its name and state; empty:
// neither.
std::array<std::string, 2> mode_lines(const wire::Snapshot& state, std::size_t left);

}  // namespace client
