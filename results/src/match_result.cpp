#include "results/match_result.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace results {
namespace {

// Format: 2026-11-22T23:59:59Z
bool is_date(const std::string& text) {
  constexpr std::string_view kForm = "dddd-dd-ddTdd:dd:ddZ";
  if (text.size() != kForm.size()) return false;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kForm[i] == 'd' ? !digit : text[i] != kForm[i]) return false;
  }
  const auto number = [&](std::size_t at) { return 10 * (text[at] - '0') + (text[at + 1] - '0'); };
  return number(5) >= 1 && number(5) <= 12 && number(8) >= 1 && number(8) <= 31 &&
         number(11) <= 23 && number(14) <= 59 && number(17) <= 60;  // with a leap second
}

bool is_text(const std::string& text) {
  return text.size() <= kMaxText && text.find('\0') == std::string::npos;
}

bool is_amount(double x) {
  return std::isfinite(x) && x >= 0.0;
}

}  // namespace

std::string problem_with(const MatchResult& result) {
  if (!is_date(result.finished_at)) {
    return "the date must be one such as 2026-11-22T23:59:59Z, not " +
           result.finished_at.substr(0, 40);
  }
  if (!is_text(result.layout) || !is_text(result.recording)) return "a text is too long";
  if (!is_amount(result.play_seconds)) return "the match's length is not a number of seconds";
  if (const auto& s = result.shot_speeds; s && !(is_amount(s->median) && is_amount(s->fastest))) {
    return "a shot's speed is not a number";
  }
  for (const Team& team : result.teams) {
    if (team.players.empty() || team.players.size() > kMaxPlayersOfTeam) {
      return "a team has " + std::to_string(team.players.size()) + " players, not 1 to 8";
    }
    for (const Player& player : team.players) {
      if (player.name.empty() || !is_text(player.name) || !is_text(player.kind)) {
        return "a player's name is empty or too long";
      }
      if (!is_amount(player.share) || player.share > 1.0) {
        return "a player's fraction of the match is not a number from 0 to 1";
      }
    }
    if (team.statistics && !is_amount(team.statistics->possession_seconds)) {
      return "a team's possession is not a number of seconds";
    }
    if (team.statistics && !is_amount(team.statistics->fastest_shot.value_or(0.0)))
      return "a shot's speed is not a number";
  }
  return {};
}

}  // namespace results
