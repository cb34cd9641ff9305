// The stored data of a finished match, as plain data. SI units.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace results {

inline constexpr int kTeams = 2;
inline constexpr std::size_t kMaxText = 4096;        // bytes of a text, such as a name or a path
inline constexpr std::size_t kMaxPlayersOfTeam = 8;  // the number of rods of a table

// Players with the same name are the same player, of any kind.
struct Player {
  std::string name;  // 1 to kMaxText bytes of UTF-8 without NUL
  std::string kind;  // such as "person", "computer"
  // Fraction of the match's time that this player played. It is below 1 for a player who came late,
  // left, or was replaced.
  double share = 1.0;  // 0 .. 1
  // The player was absent at the end, or for too long; see docs/rules.md. Arriving late does not
  // count as leaving.
  bool left = false;
  bool operator==(const Player&) const = default;
};

// Counts of a team.
struct TeamStatistics {
  std::uint64_t shots = 0, shots_on_target = 0, saves = 0, passes = 0, touches = 0;
  std::uint64_t own_goals = 0;           // goals of the team into its own goal
  double possession_seconds = 0.0;       // time in which it was the last to touch the ball
  std::optional<double> fastest_shot{};  // [m/s]; 0: no shot; none: not recorded
  bool operator==(const TeamStatistics&) const = default;
};

struct Team {
  std::vector<Player> players;  // at most kMaxPlayersOfTeam
  std::uint32_t goals = 0;      // in a match of several sets: the sets won
  std::optional<TeamStatistics> statistics;
  bool operator==(const Team&) const = default;
};

struct ShotSpeeds {
  double median = 0.0, fastest = 0.0;  // of both teams [m/s]
  bool operator==(const ShotSpeeds&) const = default;
};

struct MatchResult {
  std::int64_t id = 0;      // assigned by the store
  std::string finished_at;  // UTC, such as 2026-11-22T23:59:59Z; from the caller's clock
  std::string layout;       // such as "tournament"
  std::uint32_t goals_to_win = 0, max_goals = 0;  // or sets, as for Team::goals
  std::uint64_t seed = 0;
  double play_seconds = 0.0;  // of the match clock
  std::array<Team, kTeams> teams;
  std::optional<ShotSpeeds> shot_speeds;
  std::string recording;  // path, or empty
  bool operator==(const MatchResult&) const = default;

  // The team with more goals; none for a draw.
  std::optional<int> winner() const {
    if (teams[0].goals == teams[1].goals) return std::nullopt;
    return teams[0].goals > teams[1].goals ? 0 : 1;
  }
};

// Empty if valid; otherwise the problem: an invalid date, a text that is too long, invalid or too
// many players, a number that is not finite.
std::string problem_with(const MatchResult& result);

}  // namespace results
