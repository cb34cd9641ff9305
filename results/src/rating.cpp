#include "results/rating.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace results {
namespace {

using Players = std::map<std::string, Standing>;

double weighted_rating(const Team& team, Players& players) {
  double sum = 0.0, weights = 0.0;
  for (const Player& player : team.players) {
    const double weight = std::max(player.share, 1e-6);  // avoids a division by 0
    sum += weight * players[player.name].rating;
    weights += weight;
  }
  return sum / weights;
}

// The same computer may have played for both teams: such a match does not count as one.
bool meets_himself(const MatchResult& match) {
  std::set<std::string> names;
  for (const Player& player : match.teams[0].players)
    if (played(player)) names.insert(player.name);
  return std::any_of(
      match.teams[1].players.begin(), match.teams[1].players.end(),
      [&](const Player& player) { return played(player) && names.count(player.name) > 0; });
}

void count(const MatchResult& match, int side, Players& players) {
  const Team &own = match.teams[static_cast<std::size_t>(side)],
             &other = match.teams[static_cast<std::size_t>(1 - side)];
  const auto winner = match.winner();
  for (const Player& player : own.players) {
    Standing& standing = players[player.name];
    standing.name = player.name;
    standing.kind = player.kind;
    if (!counts_for(player)) {
      ++standing.not_counted;
      continue;
    }
    ++standing.matches;
    if (winner || player.left)
      ++(!player.left && *winner == side ? standing.wins : standing.losses);
    standing.goals_for += own.goals;
    standing.goals_against += other.goals;
    if (own.statistics)
      standing.fastest_shot =
          std::max(standing.fastest_shot, own.statistics->fastest_shot.value_or(0.0));
    if (own.statistics && other.statistics) {
      standing.saves += own.statistics->saves;
      standing.shots_faced += other.statistics->shots_on_target;
    }
  }
}

}  // namespace

std::vector<Standing> standings(std::span<const MatchResult> matches) {
  Players players;
  for (const MatchResult& match : matches) {
    if (match.teams[0].players.empty() || match.teams[1].players.empty()) continue;
    const double ratings[] = {weighted_rating(match.teams[0], players),
                              weighted_rating(match.teams[1], players)};
    for (const int side : {0, 1}) count(match, side, players);
    const bool decided = match.winner() && !meets_himself(match);
    for (const int side : {0, 1}) {
      const double expected =
          1.0 / (1.0 + std::pow(10.0, (ratings[1 - side] - ratings[side]) / 400.0));
      for (const Player& player : match.teams[static_cast<std::size_t>(side)].players) {
        if (!player.left && !(decided && played(player))) continue;
        const double score = !player.left && *match.winner() == side ? 1.0 : 0.0;
        players[player.name].rating += kRatingGain * (score - expected);
      }
    }
  }
  std::vector<Standing> sorted;
  for (const auto& [name, standing] : players) sorted.push_back(standing);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Standing& a, const Standing& b) { return a.rating > b.rating; });
  return sorted;
}

double rating_of(const Team& team, std::span<const Standing> standings) {
  double sum = 0.0, count = 0.0;
  const bool all = std::ranges::none_of(team.players, played);
  for (const Player& player : team.players) {
    if (!all && !played(player)) continue;
    const auto own = std::ranges::find(standings, player.name, &Standing::name);
    sum += own != standings.end() ? own->rating : kFirstRating;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : kFirstRating;
}

}  // namespace results
