// The settings of a match that a person can change while the server runs: by a command to the match
// (foosball/match.h), by a client's request, or by options. Plain data.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "foosball/rules.h"

namespace foosball {

inline constexpr int kMaxGoals = 99;  // to win a set
inline constexpr int kMaxSets = 17;   // of a match (best of)
inline constexpr std::uint32_t kMaxMatchMs = 3'600'000;
inline constexpr int kGoalsBeyond = 3;  // margin of max_goals over goals_to_win: 8 for 5
inline constexpr std::uint32_t kFirstDate = 1000'01'01, kLastDate = 9999'12'31;

struct GameSetup {
  Mode mode = Mode::match;
  RuleSet rules = RuleSet::arcade;
  int goals = 0;               // to win a set, 1..kMaxGoals; 0: default of the rules
  int sets = 0;                // best of this number, odd, 1..kMaxSets; 0: default of the rules
  std::uint32_t match_ms = 0;  // playing time of a set [ms], at most kMaxMatchMs; 0: no limit
  bool change_sides = false;   // between sets
  std::uint32_t date = 0;      // of a challenge, such as 20261122; otherwise 0

  bool operator==(const GameSetup&) const = default;
};

// The settings that a mode lets a person choose.
constexpr bool chooses_rules(Mode mode) {
  return mode != Mode::challenge;
}
constexpr bool has_end(Mode mode) {
  return mode == Mode::match || mode == Mode::ladder;
}
constexpr bool chooses_opponent(Mode mode) {
  return mode == Mode::match || mode == Mode::training;
}

// Resets the settings that the mode fixes to their defaults. Keeps the date.
constexpr GameSetup only_chosen(GameSetup setup) {
  if (!chooses_rules(setup.mode)) setup.rules = RuleSet::arcade;
  if (!has_end(setup.mode)) {
    setup.goals = setup.sets = 0;
    setup.match_ms = 0;
    setup.change_sides = false;
  }
  return setup;
}

// A valid date of the Gregorian calendar.
constexpr bool is_date(std::uint32_t date) {
  const std::uint32_t year = date / 10000, month = date / 100 % 100, day = date % 100;
  if (date < kFirstDate || date > kLastDate || month < 1 || month > 12) return false;
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  const bool short_month = month == 4 || month == 6 || month == 9 || month == 11;
  const std::uint32_t days = month == 2 ? (leap ? 29 : 28) : short_month ? 30 : 31;
  return day >= 1 && day <= days;
}

// Every number is in its range.
constexpr bool in_range(const GameSetup& setup) {
  return static_cast<int>(setup.mode) < kModes && static_cast<int>(setup.rules) < kRuleSets &&
         setup.goals >= 0 && setup.goals <= kMaxGoals && setup.match_ms <= kMaxMatchMs &&
         (setup.sets == 0 || (setup.sets >= 1 && setup.sets <= kMaxSets && setup.sets % 2 == 1));
}

// In range, and consistent with the mode.
constexpr bool playable(const GameSetup& setup) {
  const bool dated = setup.mode == Mode::challenge ? is_date(setup.date) : setup.date == 0;
  return in_range(setup) && dated && setup == only_chosen(setup);
}

// The rules of a setup. Precondition: in_range(setup). The screens' durations are not part of a
// setup: they come from `screens`.
constexpr Rules rules_of(const GameSetup& setup, const Rules& screens = {}) {
  Rules rules = setup.mode == Mode::challenge  ? challenge_rules()
                : setup.rules == RuleSet::itsf ? itsf_rules()
                                               : arcade_rules();
  if (setup.match_ms > 0) {
    rules.match_seconds = setup.match_ms / 1000.0;
    rules.goals_to_win = rules.max_goals = kMaxGoals;
  }
  if (setup.goals > 0) {
    rules.goals_to_win = setup.goals;
    rules.max_goals = std::min(kMaxGoals, setup.goals + kGoalsBeyond);
  }
  if (setup.sets > 0) rules.sets_to_win = (setup.sets + 1) / 2;
  rules.change_sides = setup.change_sides;
  rules.ceremony_seconds = screens.ceremony_seconds;
  rules.end_seconds = screens.end_seconds;
  rules.idle_seconds = screens.idle_seconds;
  rules.attract_seconds = screens.attract_seconds;
  return rules;
}

// Inverse of rules_of(), as far as a setup can express the rules. date: of a challenge.
inline GameSetup setup_of(Mode mode, const Rules& rules, std::uint32_t date = 0) {
  GameSetup setup{.mode = mode, .rules = rules.set};
  const bool timed = rules.match_seconds > 0.0;
  setup.goals = timed && rules.goals_to_win == kMaxGoals ? 0 : rules.goals_to_win;
  setup.sets = 2 * rules.sets_to_win - 1;
  setup.match_ms = static_cast<std::uint32_t>(std::lround(rules.match_seconds * 1000.0));
  setup.change_sides = rules.change_sides;
  setup.date = mode == Mode::challenge ? date : 0;
  return only_chosen(setup);
}

}  // namespace foosball
