// Storage of finished matches, the players' answers, and reports to clients.
#include <algorithm>
#include <cmath>
#include <utility>

#include "results/rating.h"
#include "server/match_record.h"
#include "server_impl.h"

namespace server {

// Counts the players of this tick. A person plays the rods of the seat, unless the computer stands
// in.
void Server::Impl::count_players() {
  const foosball::MatchView& view = match.view();
  if (view.screen != foosball::Screen::play || view.paused || view.attract) return;
  lineup.begin_tick();
  const RodSet stand_ins = desk.stand_ins();
  for (std::uint8_t team = 0; team < foosball::kTeams; ++team) {
    const RodSet own = rods_of_team(view.layout, team);
    bool person = false, cabinet = false, computer = view.computer[team];
    for (const Client& client : clients) {
      const RodSet rods = client.rods & own;
      person = person || rods != 0;
      for (int rod = 0; rod < foosball::kRods; ++rod) {
        if ((rods >> rod & 1) == 0) continue;
        if ((stand_ins >> rod & 1) == 0) {
          lineup.add(team, Lineup::Kind::person, client.at(rod).data());
        } else {
          lineup.keep_seat(team, client.at(rod).data());
        }
      }
    }
    for (int rod = 0; rod < foosball::kRods; ++rod) {
      if ((own >> rod & 1) == 0) continue;
      cabinet = cabinet || desk.driver(rod) == RodDriver::cabinet;
      computer = computer || (stand_ins >> rod & 1) != 0;
    }
    if (cabinet && !person) lineup.add(team, Lineup::Kind::cabinet, "cabinet");
    if (computer) lineup.add(team, Lineup::Kind::computer, "computer");
  }
}

// Stores the result of the last tick. A demonstration match is not stored.
void Server::Impl::keep_result() {
  foosball::RodTargets targets;
  for (int rod = 0; rod < foosball::kRods; ++rod) targets[rod] = from_grid(next.rods[rod]);
  const bool over = scribe.observe(match, targets);
  if (scribe.begins()) begin_lineup();
  count_players();
  if (!over || match.view().attract) return;
  results::MatchResult result = scribe.result(match.view(), players());
  tell_who_is_not_rated_as_the_team(result);
  result.finished_at = options.date();
  result.recording = options.record;
  if (!results->add(std::move(result), ++matches) || !options.questionnaire) return;
  RodSet cabinet = 0;
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if (desk.driver(rod) == RodDriver::cabinet) cabinet |= RodSet(1u << rod);
  }
  control.ask(matches, cabinet);
}

void Server::Impl::keep_answers(const ControlEvent& event) {
  static_assert(wire::kQuestionCount == results::kQuestions);
  static_assert(wire::kMaxScore == results::kMaxScore);
  if (!results) return;
  results::Answers answers{.team = event.team, .rods = event.answers.rods};
  std::ranges::copy(event.answers.scores, answers.scores.begin());
  results->answer(answers, event.answers.match);
}

void Server::Impl::begin_lineup() {
  lineup.begin();
  if (std::exchange(not_counted_reported, false))
    notify(Topic::not_counted, {}, "another match begins");
  if (std::exchange(leavers_reported, false)) notify(Topic::leavers, {}, "another match begins");
}

MatchScribe::Players Server::Impl::players() const {
  MatchScribe::Players players;
  const auto return_ticks = static_cast<std::uint64_t>(options.limits.seat_kept_us / 1000);
  for (int team = 0; team < foosball::kTeams; ++team) {
    players[team] = lineup.players(team, return_ticks);
    for (results::Player& player : players[team])
      if (player.kind == "computer") player.name = "computer " + to_text(desk.computer_player());
    if (players[team].empty()) players[team] = {{"nobody", "person"}};
  }
  return players;
}

// The reason: they left, or joined too late.
void Server::Impl::tell_who_is_not_rated_as_the_team(const results::MatchResult& result) {
  std::string late, left;
  for (const results::Team& team : result.teams) {
    for (const results::Player& player : team.players) {
      if (player.kind != "person" || results::played(player)) continue;
      std::string& who = player.left ? left : late;
      const auto percent = std::lround(100.0 * player.share);
      who += (who.empty() ? "" : ", ") + player.name + " (" + std::to_string(percent) + "%)";
    }
  }
  if (!late.empty())
    notify(Topic::not_counted, wire::make_sentence<wire::SentenceId::not_rated>(late));
  if (!left.empty())
    notify(Topic::leavers, wire::make_sentence<wire::SentenceId::lost_by_leaving>(left));
  not_counted_reported = !late.empty();
  leavers_reported = !left.empty();
}

void Server::Impl::watch_results() {
  wire::Sentence problem;
  if (!results || !results->problem_changed(problem)) return;
  notify(Topic::results, problem, "results are stored again");
}

// Clients show it at the end of the match and on the logo screen.
void Server::Impl::send_report() {
  ResultsLog::Report kept;
  if (!results || !results->report_changed(kept)) return;
  wire::Report report;
  report.match = kept.number;
  for (std::size_t t = 0; t < report.teams.size(); ++t) {
    const auto s = kept.match.teams[t].statistics.value_or(results::TeamStatistics{});
    const auto count = [](std::uint64_t n) {
      return static_cast<std::uint32_t>(std::min<std::uint64_t>(n, 0xffffffffu));
    };
    report.teams[t] = {count(s.shots),
                       count(s.shots_on_target),
                       count(s.saves),
                       count(s.passes),
                       count(s.own_goals),
                       static_cast<float>(s.possession_seconds),
                       static_cast<float>(kept.rating[t]),
                       static_cast<float>(kept.change[t]),
                       static_cast<float>(s.fastest_shot.value_or(0.0))};
  }
  for (const results::Standing& one : kept.fame) {
    const auto small = [](std::uint64_t n) { return static_cast<std::uint32_t>(n); };
    report.fame.push_back({one.name, static_cast<float>(one.rating), small(one.matches),
                           small(one.wins), static_cast<float>(one.fastest_shot),
                           small(one.shots_faced), small(one.saves)});
  }
  control.report(report);
}

}  // namespace server
