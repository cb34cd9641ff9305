// The questionnaire after a match: questions, a player's answers, and their summary.
//
// The paper (section 5.1) collected questionnaires after play, but prints neither questions nor
// results. These questions are ours, one statement for each property that the paper claims for the
// game; docs/questionnaire.md names the passages. Scale: Likert, 1 strongly disagree .. 5 strongly
// agree.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "results/match_result.h"

namespace results {

inline constexpr int kQuestions = 6;
inline constexpr int kMaxScore = 5;

struct Question {
  const char* key;        // column in exports; must not change once answers exist
  const char* statement;  // English, as the game's window shows it
};
inline constexpr std::array<Question, kQuestions> kQuestionnaire{{
    {"fun", "Playing was fun."},
    {"intuitive", "I knew at once how to move the figures."},
    {"responsive", "The figures did what my hands did."},
    {"plausible", "The ball moved as I expected it to."},
    {"visible", "I could always see where the ball was, and how high."},
    {"absorbed", "I thought of the game only, not of its controls."},
}};

// One player's answers after a match. No name: the match lists the players of each team.
struct Answers {
  std::int64_t id = 0;     // assigned by the store
  std::int64_t match = 0;  // MatchResult::id
  int team = 0;
  std::uint32_t rods = 0;                // of the player, bit 0 at -x; 1 .. 255
  std::array<int, kQuestions> scores{};  // 1 .. kMaxScore; 0: not answered
  bool operator==(const Answers&) const = default;
};

// Empty if valid; otherwise the problem: an unknown team or rod, a score out of range, or no score
// at all.
std::string problem_with(const Answers& answers);

struct QuestionSummary {
  std::uint64_t n = 0;                               // number of answers
  std::array<std::uint64_t, kMaxScore> counts{};     // of each score, from 1
  double mean = 0.0, median = 0.0, deviation = 0.0;  // sample standard deviation; 0 if n < 2
};
std::array<QuestionSummary, kQuestions> summarise(std::span<const Answers> all);

// Formats for a person, and for programs one row per sheet with its match's statistics, and the
// summary. matches: those that the answers refer to; for other matches only the number is written.
std::string answers_table(std::span<const Answers> all);
std::string answers_csv(std::span<const Answers> all, std::span<const MatchResult> matches);
std::string answers_json(std::span<const Answers> all);

}  // namespace results
