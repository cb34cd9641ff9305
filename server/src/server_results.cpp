// What is kept of finished matches, what players answer about them, and what clients are told.
#include <algorithm>
#include <utility>

#include "server/match_record.h"
#include "server_impl.h"

namespace server {

// Of the last tick. What is shown while nobody plays is nobody's match.
void Server::Impl::keep_result() {
  foosball::RodTargets targets;
  for (int rod = 0; rod < foosball::kRods; ++rod) targets[rod] = from_grid(next.rods[rod]);
  if (!scribe.observe(match, targets) || match.view().attract) return;
  results::MatchResult result = scribe.result(match.view(), players());
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

MatchScribe::Players Server::Impl::players() const {
  MatchScribe::Players players;
  for (std::uint8_t team = 0; team < foosball::kTeams; ++team) {
    const auto client = std::find_if(clients.begin(), clients.end(),
                                     [&](const Client& c) { return c.team == team; });
    if (client != clients.end()) {
      players[team] = {client->name.data(), "person"};
    } else if (options.computer[team] || match.view().computer[team]) {
      players[team] = {"computer " + to_text(desk.computer_player()), "computer"};
    } else {
      players[team] = {desk.devices().empty() ? "nobody" : "cabinet", "person"};
    }
    if (players[team].name.empty()) players[team].name = "person";
  }
  return players;
}

void Server::Impl::watch_results() {
  std::string problem;
  if (!results || !results->problem_changed(problem)) return;
  const auto level = problem.empty() ? wire::Notice::Level::cleared : wire::Notice::Level::warning;
  notify(level, static_cast<std::uint32_t>(Topic::results),
         problem.empty() ? "results are kept again" : problem);
}

// Clients show it at the match's end and on the logo.
void Server::Impl::tell_report() {
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
                       static_cast<float>(kept.change[t])};
  }
  for (const results::Standing& one : kept.fame) {
    const auto small = [](std::uint64_t n) { return static_cast<std::uint32_t>(n); };
    report.fame.push_back(
        {one.name, static_cast<float>(one.rating), small(one.matches), small(one.wins)});
  }
  control.report(report);
}

}  // namespace server
