// What is kept of a finished match, as plain data. SI units.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace results {

inline constexpr int kTeams = 2;
inline constexpr std::size_t kMaxText = 4096;        // bytes of a text: name, path
inline constexpr std::size_t kMaxPlayersOfTeam = 8;  // as many as a table has rods

// Whose name is the same is the same player, whatever the kind.
struct Player {
  std::string name;  // 1 to kMaxText bytes of UTF-8 without a zero
  std::string kind;  // as "person", "computer"
  // Of the match's time, what this player played: less for who came late, left, or was replaced.
  double share = 1.0;  // 0 .. 1
  // Was away at the end, or for too long; see docs/rules.md. Whoever only came late has not left.
  bool left = false;
  bool operator==(const Player&) const = default;
};

// Counts of a team; of none where they were not taken.
struct TeamStatistics {
  std::uint64_t shots = 0, shots_on_target = 0, saves = 0, passes = 0, touches = 0;
  std::uint64_t own_goals = 0;           // that the team shot into its own goal
  double possession_seconds = 0.0;       // since its last touch
  std::optional<double> fastest_shot{};  // [m/s], 0: the team did not shoot; none: not kept
  bool operator==(const TeamStatistics&) const = default;
};

struct Team {
  std::vector<Player> players;  // at most kMaxPlayersOfTeam
  std::uint32_t goals = 0;      // of a match of several sets: the sets won
  std::optional<TeamStatistics> statistics;
  bool operator==(const Team&) const = default;
};

struct ShotSpeeds {
  double median = 0.0, fastest = 0.0;  // of both teams [m/s]
  bool operator==(const ShotSpeeds&) const = default;
};

struct MatchResult {
  std::int64_t id = 0;      // given by the store
  std::string finished_at;  // UTC, as 2026-11-22T23:59:59Z; the caller's clock
  std::string layout;       // as "tournament"
  std::uint32_t goals_to_win = 0, max_goals = 0;  // or sets, as Team::goals
  std::uint64_t seed = 0;
  double play_seconds = 0.0;  // of the match clock
  std::array<Team, kTeams> teams;
  std::optional<ShotSpeeds> shot_speeds;
  std::string recording;  // path, or empty
  bool operator==(const MatchResult&) const = default;

  // The team with more goals; nobody's where they are equal.
  std::optional<int> winner() const {
    if (teams[0].goals == teams[1].goals) return std::nullopt;
    return teams[0].goals > teams[1].goals ? 0 : 1;
  }
};

// Empty, or what is wrong with it: a date that is none, a text that is too long, players that are
// none or too many, a number that is not finite.
std::string problem_with(const MatchResult& result);

}  // namespace results
