// What is played, as clients ask for it and are told it (wire::Game): a setup of the match, and who
// plays where a computer does. Which requests are refused, and why.
#pragma once

#include <cstdint>
#include <string>

#include "foosball/computer_player.h"
#include "foosball/game_setup.h"
#include "foosball/match.h"
#include "wire/control.h"
#include "wire/sentence.h"

namespace server {

// A computer player as people choose it.
struct Opponent {
  int level = foosball::PlayerSpec{}.level;
  int style = 0;  // 1 + foosball::PlayStyle; 0: the one that suits the level

  bool operator==(const Opponent&) const = default;
};
foosball::PlayerSpec player_of(const Opponent& opponent);
// The other way round; a classic player is told as its level.
Opponent opponent_of(const foosball::PlayerSpec& player);

// Who plays where a computer does: the day's in a challenge, by the rung on the ladder, else the
// one that was chosen.
foosball::PlayerSpec player_in(foosball::Mode mode, int rung, std::uint64_t challenge,
                               const foosball::PlayerSpec& chosen);

// What a challenge is the same for everybody by, and what else is fixed at a server.
struct GameSite {
  bool computer = false;            // plays a team
  bool cabinet = false;             // its players walk round the table
  bool tournament_table = true;     // the challenge's
  bool built_in_characters = true;  // are the first in the list, as they are
  bool default_tuning = true;       // at this moment
};
GameSite site_of(const foosball::MatchDesc& match, bool computer, bool cabinet);

// Empty: it can be played here, whether a client asks for it or the options do. Whatever numbers a
// stranger sends.
wire::Sentence why_not(const wire::Game& asked, const GameSite& site);

// Precondition: its numbers are in their ranges. date: of a challenge.
foosball::GameSetup setup_of(const wire::Game& asked, std::uint32_t date);
// As a client asks for it, without an opponent or a date.
wire::Game to_game(const foosball::GameSetup& setup);
// As the match has it chosen; waits: another game is in hand.
wire::Game to_game(const foosball::GameSetup& setup, const Opponent& opponent, bool waits);

// "2026-11-22T23:59:59Z" as 20261122; 0: it begins with no date.
std::uint32_t day_of(const std::string& date);

}  // namespace server
