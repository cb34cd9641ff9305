#include "results/questionnaire.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "csv.h"

namespace results {
namespace {

// The middle score in order, or the mean of the two middle ones.
double median_of(const QuestionSummary& summary) {
  const auto at = [&](std::uint64_t rank) {
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < summary.counts.size(); ++i) {
      below += summary.counts[i];
      if (rank < below) return static_cast<double>(i + 1);
    }
    return 0.0;
  };
  return 0.5 * (at((summary.n - 1) / 2) + at(summary.n / 2));
}

QuestionSummary summary_of(std::span<const Answers> all, std::size_t question) {
  QuestionSummary summary;
  double sum = 0.0, squares = 0.0;
  for (const Answers& answers : all) {
    const int score = answers.scores[question];
    if (score == 0) continue;
    ++summary.n;
    ++summary.counts[static_cast<std::size_t>(score - 1)];
    sum += score;
    squares += static_cast<double>(score) * score;
  }
  if (summary.n == 0) return summary;
  const auto n = static_cast<double>(summary.n);
  summary.mean = sum / n;
  summary.median = median_of(summary);
  if (summary.n > 1)
    summary.deviation =
        std::sqrt(std::max(0.0, squares - n * summary.mean * summary.mean) / (n - 1));
  return summary;
}

}  // namespace

std::string problem_with(const Answers& answers) {
  if (answers.team < 0 || answers.team >= kTeams) return "a player has an invalid team";
  if (answers.rods == 0 || answers.rods > 0xff) return "a player has no valid rods";
  bool any = false;
  for (const int score : answers.scores) {
    if (score < 0 || score > kMaxScore) return "an answer is beyond the scale";
    any = any || score != 0;
  }
  return any ? "" : "nothing was answered";
}

std::array<QuestionSummary, kQuestions> summarise(std::span<const Answers> all) {
  std::array<QuestionSummary, kQuestions> summaries;
  for (std::size_t q = 0; q < summaries.size(); ++q) summaries[q] = summary_of(all, q);
  return summaries;
}

std::string answers_table(std::span<const Answers> all) {
  std::string text = fmt::format(
      "{} players answered; 1 strongly disagree .. {} strongly agree\n\n", all.size(), kMaxScore);
  text += fmt::format("{:<54} {:>5} {:>6} {:>6} {:>6}  {:>4} {:>4} {:>4} {:>4} {:>4}\n", "", "n",
                      "median", "mean", "sd", "1", "2", "3", "4", "5");
  const auto summaries = summarise(all);
  for (std::size_t q = 0; q < summaries.size(); ++q) {
    const QuestionSummary& s = summaries[q];
    const auto number = [&](double x, int digits) {
      return s.n > 0 ? fmt::format("{:.{}f}", x, digits) : std::string("-");
    };
    text += fmt::format("{:<54} {:>5} {:>6} {:>6} {:>6} ", kQuestionnaire[q].statement, s.n,
                        number(s.median, 1), number(s.mean, 2), number(s.deviation, 2));
    for (const std::uint64_t count : s.counts) text += fmt::format(" {:>4}", count);
    text += "\n";
  }
  return text;
}

std::string answers_csv(std::span<const Answers> all, std::span<const MatchResult> matches) {
  std::string text = "sheet,match,finished_at,layout,play_s,team,rods,goals_for,goals_against";
  for (const Question& question : kQuestionnaire) text += fmt::format(",{}", question.key);
  text += "\r\n";
  for (const Answers& a : all) {
    const auto match = std::ranges::find(matches, a.match, &MatchResult::id);
    const auto team = static_cast<std::size_t>(a.team);
    text += fmt::format("{},{},", a.id, a.match);
    if (match != matches.end()) {
      text += fmt::format("{},{},{:.6g},{},{},{},{}", csv_cell(match->finished_at),
                          csv_cell(match->layout), match->play_seconds, a.team, a.rods,
                          match->teams[team].goals, match->teams[1 - team].goals);
    } else {
      text += fmt::format(",,,{},{},,", a.team, a.rods);
    }
    for (const int score : a.scores) text += score == 0 ? "," : fmt::format(",{}", score);
    text += "\r\n";
  }
  return text;
}

std::string answers_json(std::span<const Answers> all) {
  nlohmann::ordered_json out;
  out["sheets"] = all.size();
  out["questions"] = nlohmann::ordered_json::array();
  const auto summaries = summarise(all);
  for (std::size_t q = 0; q < summaries.size(); ++q) {
    const QuestionSummary& s = summaries[q];
    nlohmann::ordered_json one{{"key", kQuestionnaire[q].key},
                               {"statement", kQuestionnaire[q].statement},
                               {"n", s.n},
                               {"counts", s.counts}};
    if (s.n > 0) {
      one["median"] = s.median;
      one["mean"] = s.mean;
      one["sd"] = s.deviation;
    }
    out["questions"].push_back(std::move(one));
  }
  return out.dump(2) + "\n";
}

}  // namespace results
