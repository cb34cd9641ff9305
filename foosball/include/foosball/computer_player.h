// A computer player. It sees what a person sees, and moves all or some rods of one team with a
// person's limits (reaction delay, motor noise, hand speed, two hands). Deterministic: its state
// depends only on its seed and on the views and rods that it was given, one per tick.
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
    level,    // a level and a style: what the game offers
    classic,  // the original player, with a skill 0..1: a reference for tests and studies
  };
  Kind kind = Kind::level;
  int level = 2;  // 1..kLevels
  PlayStyle style = PlayStyle::wall;
  double skill = 0.6;  // of classic

  bool operator==(const PlayerSpec&) const = default;
};

// Accepts "3", "3:shooter", "classic", "classic:0.9". A level without a style gets its default
// style. Rejects anything else with Errc::invalid_argument and a sentence that lists the choices.
vp::Expected<PlayerSpec> parse_player(std::string_view text);
std::string to_text(const PlayerSpec& spec);
// The opponent of a challenge, drawn from its date: the same for everybody.
PlayerSpec challenge_opponent(std::uint64_t challenge);
// The decision parameters of this level and style. Clamps a level out of range.
Judgment judgment_of(int level, PlayStyle style);

// Digest of every number of every player: levels, styles, the classic player. A program that
// continues earlier games compares it to detect changed players.
std::uint64_t players_digest();

struct ComputerPlayerDesc {
  int team = 1;
  std::uint64_t seed = 1;
  bool opens_match = true;             // pushes at the logo; false: a person has to
  PlayerSpec player{};                 // clamped to its range
  std::optional<Judgment> judgment{};  // of a level player; none: judgment_of() its level and style
};

inline constexpr std::uint8_t kAllRods = 0xFF;  // as bits, indexed as TableSpec::rods

class ComputerPlayer {
 public:
  explicit ComputerPlayer(const ComputerPlayerDesc& desc);
  ~ComputerPlayer();
  ComputerPlayer(ComputerPlayer&&) noexcept;
  ComputerPlayer& operator=(ComputerPlayer&&) noexcept;

  // Sets the targets of its rods: those of its team among `rods`. It neither reads nor changes
  // other targets. The other rods of its team belong to a team mate: it sees their positions, as it
  // sees the opponent's. `rods` may change from tick to tick. With no rods it releases all, stays
  // ready to play, and observes afresh when it gets rods again. With all rods of its team it also
  // operates the screens: pushes at the logo, chooses and confirms a character. With only some of
  // them, it leaves that to the team mate.
  void play(const MatchView& view, RodTargets& targets, std::uint8_t rods = kAllRods);
  // The pass that a foot made in the last play(), if any.
  PlayedPass passed() const;

  struct Impl;  // a subclass per kind

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace foosball
