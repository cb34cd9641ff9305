// What a match is played by: the rule set with every number a caller may change, the modes, and the
// reasons for which the referee stops play. docs/rules.md explains each; numbers such as "8.2" name
// the article of the ITSF rule book (2016).
#pragma once

#include <cstdint>

namespace foosball {

enum class RuleSet : std::uint8_t { arcade, itsf };
inline constexpr int kRuleSets = 2;

enum class Mode : std::uint8_t {
  match,      // one match between two sides
  training,   // the ball is served to a chosen man, again and again; nothing ends it
  challenge,  // timed, with characters drawn from the seed: the same for everybody who has the seed
  ladder,     // matches against stronger and stronger opponents
};
inline constexpr int kModes = 4;
inline constexpr int kLadderRungs = 5;

// What a spin costs (15): a ball struck by a rod that turned more than 360 degrees before the
// strike, or turns more than 360 degrees after it.
enum class SpinRule : std::uint8_t {
  allowed,    // not judged
  void_goal,  // a goal from it does not count, and the opponent's defence has the ball
  loss,       // play stops: the opponent serves
};
inline constexpr int kSpinRules = 3;

enum class Foul : std::uint8_t {
  possession,  // held longer than allowed (24)
  spin,        // (15)
  jarring,     // a rod slammed against its stop while the opponent has the ball (16, 17)
  technical,   // jarring for the third time and after (16.4, 27)
  time_out,    // asked for without a right to it (9)
  serve,       // straight from the serve into the goal (4.2.2), or no place was left for the ball
};
inline constexpr int kFouls = 6;

struct Rules {
  RuleSet set = RuleSet::arcade;

  // The end: sets of goals_to_win; the last possible set by `lead`, at most to max_goals (2).
  int goals_to_win = 5;
  int max_goals = 8;
  int lead = 1;
  int sets_to_win = 1;
  double match_seconds = 0.0;  // time of play of a set; 0: no limit
  bool golden_goal = true;     // time is up at a draw: the next goal wins; else the set is drawn
  bool change_sides = false;   // between sets (13)

  // The ball.
  double dead_ball_seconds = 2.0;             // within nobody's reach (8)
  double still_seconds = 5.0;                 // within reach, at rest, untouched; 0: not judged
  double possession_midfield_seconds = 10.0;  // within one rod's reach (24)
  double possession_seconds = 15.0;           // the same for the other rods

  // Conduct.
  int time_outs = 2;  // of a team in a set (9)
  double time_out_seconds = 30.0;
  SpinRule spin = SpinRule::void_goal;
  bool jarring = false;

  // The screens.
  double ceremony_seconds = 4.0;  // a goal is shown again in slow motion (client)
  double end_seconds = 6.0;
  double idle_seconds = 60.0;     // no person moves a rod: back to the logo; 0: never
  double attract_seconds = 30.0;  // at the logo, until two computers show a match; 0: never

  bool operator==(const Rules&) const = default;
};

// For so long a rod may have the ball (24): a midfield, or any other.
constexpr double possession_limit(const Rules& rules, bool midfield) {
  return midfield ? rules.possession_midfield_seconds : rules.possession_seconds;
}

// The paper's game: first to five, played on whenever possible.
constexpr Rules arcade_rules() {
  return {};
}

// The tournament game: best of `sets` sets, the last one by two; every article that docs/rules.md
// lists is judged.
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

// Two minutes against the computer; whoever leads then has won, and a draw stays one.
constexpr Rules challenge_rules() {
  Rules rules;
  rules.goals_to_win = rules.max_goals = 99;
  rules.match_seconds = 120.0;
  rules.golden_goal = false;
  return rules;
}

}  // namespace foosball
