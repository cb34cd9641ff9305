// Players by name. src/players.cpp has the only registry: a new kind of player is one row there.
//
//   1 to 5, 3:STYLE   the computer player of a level (foosball/computer_player.h)
//   5@NAME=NUMBER,... such a player with changed values of its judgment (foosball/judgment.h)
//   classic:SKILL     the original computer player, SKILL 0 to 1 (default 0.6)
//   idle              no hand on any rod
//   spinner           every rod spins all the time, with a man level with the ball
//   one-rod:PLAYER    PLAYER with one hand and all assists (foosball/assists.h), as with a mouse
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "foosball/match.h"
#include "foosball/played_pass.h"

namespace match {

// Plays one team in one game. Deterministic: the same desc and the same views give the same
// targets.
class Player {
 public:
  virtual ~Player() = default;
  // Sets the targets of its team's rods in the set `rods` (bits). It does not change the others.
  // Call once per tick.
  virtual void play(const foosball::MatchView& view, foosball::RodTargets& targets,
                    std::uint8_t rods) = 0;
  // The pass that a foot made in the last play(), if any, for players that report it.
  virtual foosball::PlayedPass passed() const { return {}; }
};

struct PlayerDesc {
  std::string name;  // as in the list above
  int team = 0;
  std::uint64_t seed = 1;
};

// The error is a sentence that lists the valid names.
tl::expected<std::unique_ptr<Player>, std::string> make_player(const PlayerDesc& desc);

// The default opponent of the game.
std::string default_player();

struct PlayerKind {
  std::string syntax, meaning;
};
std::vector<PlayerKind> player_kinds();

}  // namespace match
