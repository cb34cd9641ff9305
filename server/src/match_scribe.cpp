#include "match_scribe.h"

#include <algorithm>

namespace server {
namespace {

using foosball::Statistics;

const char* name_of(foosball::Layout layout) {
  return layout == foosball::Layout::paper ? "paper" : "tournament";
}

}  // namespace

bool MatchScribe::observe(const foosball::Match& match, const foosball::RodTargets& targets) {
  const auto& events = match.events();
  begins_ = match.view().matches_begun != matches_begun_;
  if (begins_) {
    matches_begun_ = match.view().matches_begun;
    statistics_.begin_match();
    before_ = statistics_.totals();
  }
  statistics_.observe(match.view(), events, targets);
  return std::any_of(events.begin(), events.end(), [](const foosball::Event& event) {
    return event.kind == foosball::EventKind::match_won ||
           event.kind == foosball::EventKind::match_drawn;
  });
}

std::array<results::TeamStatistics, foosball::kTeams> statistics_of_teams(const Statistics& before,
                                                                          const Statistics& now) {
  std::array<results::TeamStatistics, foosball::kTeams> teams;
  for (std::size_t t = 0; t < teams.size(); ++t) {
    const auto more = [&](const foosball::PerTeam Statistics::*count) {
      return (now.*count)[t] - (before.*count)[t];
    };
    teams[t] = {more(&Statistics::shots),
                more(&Statistics::shots_on_target),
                more(&Statistics::saves),
                more(&Statistics::passes),
                more(&Statistics::touches),
                more(&Statistics::own_goals_swing) + more(&Statistics::own_goals_deflected),
                static_cast<double>(more(&Statistics::possession_ticks)) * foosball::kTick};
  }
  return teams;
}

std::optional<results::ShotSpeeds> shot_speeds(const Statistics& before, const Statistics& now) {
  auto speeds = now.shot_speed;
  for (std::size_t i = 0; i < speeds.bins.size(); ++i) speeds.bins[i] -= before.shot_speed.bins[i];
  if (speeds.count() == 0) return std::nullopt;
  return results::ShotSpeeds{speeds.quantile(0.5), speeds.quantile(1.0)};
}

results::MatchResult MatchScribe::result(const foosball::MatchView& view,
                                         const Players& players) const {
  results::MatchResult result;
  result.layout = name_of(match_.layout);
  const bool in_sets = view.rules.sets_to_win > 1;  // then the sets decide
  const int to_win = in_sets ? view.rules.sets_to_win : view.rules.goals_to_win;
  result.goals_to_win = static_cast<std::uint32_t>(to_win);
  result.max_goals = static_cast<std::uint32_t>(in_sets ? to_win : view.rules.max_goals);
  result.seed = view.mode == foosball::Mode::challenge ? view.challenge : match_.seed;
  result.play_seconds = view.play_seconds;
  const auto statistics = statistics_of_teams(before_, statistics_.totals());
  for (std::size_t t = 0; t < result.teams.size(); ++t) {
    const int counted = in_sets ? view.sets[t] : view.score[t];
    result.teams[t] = {players[t], static_cast<std::uint32_t>(counted), statistics[t]};
    result.teams[t].statistics->fastest_shot = statistics_.fastest_shots()[t];
  }
  result.shot_speeds = shot_speeds(before_, statistics_.totals());
  return result;
}

}  // namespace server
