// A computer player: sees what a person sees, moves the rods of one team, or some of them, with a
// person's limits (reaction delay, motor noise, hand speed, two hands). Deterministic: its state
// follows from its seed and from the views and rods that it was handed, one a tick.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "foosball/judgment.h"
#include "foosball/match.h"
#include "foosball/play_style.h"
#include "foosball/played_pass.h"
#include "vphysics/error.h"

namespace foosball {

struct PlayerSpec {
  enum class Kind : std::uint8_t {
    level,    // a level and a style: what players are offered
    classic,  // the first player, with a skill 0..1: a reference for tests and studies
  };
  Kind kind = Kind::level;
  int level = 2;  // 1..kLevels
  PlayStyle style = PlayStyle::wall;
  double skill = 0.6;  // of classic

  bool operator==(const PlayerSpec&) const = default;
};

// "3", "3:shooter", "classic", "classic:0.9". A level alone has the style that suits it. Rejects
// anything else with Errc::invalid_argument and a sentence that names the choices.
vp::Expected<PlayerSpec> parse_player(std::string_view text);
std::string to_text(const PlayerSpec& spec);
// Whom a challenge is played against, drawn from its date: the same for everybody.
PlayerSpec challenge_opponent(std::uint64_t challenge);
// What a player of this level and style judges by. Levels out of range are clamped.
Judgment judgment_of(int level, PlayStyle style);

// Differs where a number of any player does, of a level, a style or the first player: who goes on
// with games that were played before must know that it is with the same players.
std::uint64_t players_digest();

struct ComputerPlayerDesc {
  int team = 1;
  std::uint64_t seed = 1;
  bool opens_match = true;             // pushes at the logo; false: leaves that to a person
  PlayerSpec player{};                 // out of range: clamped
  std::optional<Judgment> judgment{};  // of a level; none: judgment_of() its level and style
};

inline constexpr std::uint8_t kAllRods = 0xFF;  // by bit, of TableSpec::rods

class ComputerPlayer {
 public:
  explicit ComputerPlayer(const ComputerPlayerDesc& desc);
  ~ComputerPlayer();
  ComputerPlayer(ComputerPlayer&&) noexcept;
  ComputerPlayer& operator=(ComputerPlayer&&) noexcept;

  // Targets for its rods: those of its team among `rods`; all other targets are left as they are,
  // and not read. Rods of its team that are not its own are a team mate's: it sees where they are,
  // as it sees the opponent's. They may change from tick to tick. None: it lets go, is ready to
  // play at once, and looks anew when it has some again. With its whole team it works the screens
  // too: pushes at the logo, chooses and confirms a character. With a part of it, that is left to
  // the team mate.
  void play(const MatchView& view, RodTargets& targets, std::uint8_t rods = kAllRods);
  // The pass that a foot sent off in the last play(), if one did.
  PlayedPass passed() const;

  struct Impl;  // one for each kind

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace foosball
