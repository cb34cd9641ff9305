// The rules of a match: the rule set with every adjustable number, the modes, and the reasons for
// which the referee stops play. docs/rules.md explains each. Numbers such as "8.2" are articles of
// the ITSF rule book (2016).
#pragma once

#include <cstdint>

namespace foosball {

enum class RuleSet : std::uint8_t { arcade, itsf };
inline constexpr int kRuleSets = 2;

enum class Mode : std::uint8_t {
  match,      // one match between two teams
  training,   // the ball is served to a chosen man again and again, without end
  challenge,  // timed, with characters drawn from the seed: the same for equal seeds
  ladder,     // matches against increasingly strong opponents
};
inline constexpr int kModes = 4;
inline constexpr int kLadderRungs = 5;

// Penalty of spinning (15): a ball struck by a rod that rotated more than 360 degrees before the
// strike, or rotates more than 360 degrees after it.
enum class SpinRule : std::uint8_t {
  allowed,    // not judged
  void_goal,  // a goal from it does not count; the opponent's defence gets the ball
  loss,       // play stops: the opponent serves
};
inline constexpr int kSpinRules = 3;

enum class Foul : std::uint8_t {
  possession,  // longer than the limit (24)
  spin,        // (15)
  jarring,     // a rod strikes its stop hard while the opponent has the ball (16, 17)
  technical,   // the third jarring and each after it (16.4, 27)
  time_out,    // requested without a right to it (9)
  serve,       // a goal straight from the serve (4.2.2), or no free place for the ball
};
inline constexpr int kFouls = 6;

struct Rules {
  RuleSet set = RuleSet::arcade;

  // End of a match: a set goes to goals_to_win; the last possible set needs `lead`, at most
  // max_goals (2).
  int goals_to_win = 5;
  int max_goals = 8;
  int lead = 1;
  int sets_to_win = 1;
  double match_seconds = 0.0;  // playing time of a set; 0: no limit
  bool golden_goal = true;     // after a drawn time the next goal wins; false: the set is drawn
  bool change_sides = false;   // between sets (13)

  // The ball.
  double dead_ball_seconds = 2.0;             // no man can reach it (8)
  double still_seconds = 5.0;                 // reachable, at rest, untouched; 0: not judged
  double possession_midfield_seconds = 10.0;  // within reach of one midfield rod (24)
  double possession_seconds = 15.0;           // of any other rod

  // Conduct.
  int time_outs = 2;  // per team and set (9)
  double time_out_seconds = 30.0;
  SpinRule spin = SpinRule::void_goal;
  bool jarring = false;

  // The screens.
  double ceremony_seconds = 4.0;  // the client replays the goal in slow motion
  double end_seconds = 6.0;
  double idle_seconds = 60.0;  // without a rod moved by a person, until the logo returns; 0: never
  double attract_seconds = 30.0;  // at the logo, until a demonstration match starts; 0: never

  bool operator==(const Rules&) const = default;
};

// Time limit of possession for a rod (24). midfield: of the midfield rod; otherwise of any other.
constexpr double possession_limit(const Rules& rules, bool midfield) {
  return midfield ? rules.possession_midfield_seconds : rules.possession_seconds;
}

// The paper's game: first to five goals, with as few stops as possible.
constexpr Rules arcade_rules() {
  return {};
}

// The tournament game: best of `sets` sets, the last won by two goals. The referee judges every
// article listed in docs/rules.md.
constexpr Rules itsf_rules(int sets = 5) {
  Rules rules;
  rules.set = RuleSet::itsf;
  rules.lead = 2;
  rules.sets_to_win = (sets + 1) / 2;
  rules.still_seconds = 0.0;
  rules.spin = SpinRule::loss;
  rules.jarring = true;
  return rules;
}

// Two minutes against the computer. The leader then wins; a draw stays a draw.
constexpr Rules challenge_rules() {
  Rules rules;
  rules.goals_to_win = rules.max_goals = 99;
  rules.match_seconds = 120.0;
  rules.golden_goal = false;
  return rules;
}

}  // namespace foosball
