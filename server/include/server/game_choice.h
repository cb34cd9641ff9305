// The game to play, as clients request it and receive it (wire::Game): a match setup and the
// computer player. Also validates requests and gives the reason for a rejection.
#pragma once

#include <cstdint>
#include <string>

#include "foosball/computer_player.h"
#include "foosball/game_setup.h"
#include "foosball/match.h"
#include "wire/control.h"
#include "wire/sentence.h"

namespace server {

// A computer player, as people choose it.
struct Opponent {
  int level = foosball::PlayerSpec{}.level;
  int style = 0;  // 1 + foosball::PlayStyle; 0: the default style of the level

  bool operator==(const Opponent&) const = default;
};
foosball::PlayerSpec player_of(const Opponent& opponent);
// The inverse; a classic player is reported by its level.
Opponent opponent_of(const foosball::PlayerSpec& player);

// The computer player of a match: the opponent of the day in a challenge, the opponent of the rung
// on the ladder, otherwise the chosen one.
foosball::PlayerSpec player_in(foosball::Mode mode, int rung, std::uint64_t challenge,
                               const foosball::PlayerSpec& chosen);

// Properties of this server: those that must be equal for everybody in a challenge, and others that
// are fixed.
struct GameSite {
  bool computer = false;            // plays a team
  bool cabinet = false;             // its players walk around the table
  bool tournament_table = true;     // which the challenge uses
  bool built_in_characters = true;  // are the first in the list, unmodified
  bool default_tuning = true;       // at this moment
};
GameSite site_of(const foosball::MatchDesc& match, bool computer, bool cabinet);

// The reason why the game cannot be played here; empty if it can. Used for requests of clients and
// for command-line options. Accepts any numbers: the request may be malicious.
wire::Sentence why_not(const wire::Game& asked, const GameSite& site);

// Precondition: the numbers are in their ranges. date: of a challenge.
foosball::GameSetup setup_of(const wire::Game& asked, std::uint32_t date);
// The game as a client requests it, without an opponent or a date.
wire::Game to_game(const foosball::GameSetup& setup);
// The game as the match has it; waits: it is not the current game but the next one.
wire::Game to_game(const foosball::GameSetup& setup, const Opponent& opponent, bool waits);

// "2026-11-22T23:59:59Z" as 20261122; 0 if the text does not begin with a date.
std::uint32_t day_of(const std::string& date);

}  // namespace server
