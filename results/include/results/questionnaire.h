// The questionnaire after a match: what is asked, one player's answers, and their summary.
//
// The paper (section 5.1) collected questionnaires after play and prints neither its questions nor
// its results. These are ours, one statement for each property that the paper claims for the game;
// docs/questionnaire.md names the passages. Scale: Likert, 1 strongly disagree .. 5 strongly agree.
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
  const char* key;        // column in exports; never changed once answers were collected
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

// What one player answered after a match. No name: the match has the players of each team.
struct Answers {
  std::int64_t id = 0;     // given by the store
  std::int64_t match = 0;  // MatchResult::id
  int team = 0;
  std::uint32_t rods = 0;                // that the player had, bit 0 at -x; 1 .. 255
  std::array<int, kQuestions> scores{};  // 1 .. kMaxScore; 0: not answered
  bool operator==(const Answers&) const = default;
};

// Empty, or what is wrong: a team or rods that there are not, a score beyond the scale, no score.
std::string problem_with(const Answers& answers);

struct QuestionSummary {
  std::uint64_t n = 0;                               // who answered it
  std::array<std::uint64_t, kMaxScore> counts{};     // of each score, from 1
  double mean = 0.0, median = 0.0, deviation = 0.0;  // sample deviation; of n < 2: 0
};
std::array<QuestionSummary, kQuestions> summarise(std::span<const Answers> all);

// For a person; one row a sheet, with its match's figures; the summary for programs. matches: those
// that the answers name; of others only the number is written.
std::string answers_table(std::span<const Answers> all);
std::string answers_csv(std::span<const Answers> all, std::span<const MatchResult> matches);
std::string answers_json(std::span<const Answers> all);

}  // namespace results
