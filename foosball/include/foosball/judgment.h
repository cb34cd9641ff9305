// Parameters of a computer player's decisions, without a person's limits (delay, hand speeds, aim).
// Each has a name, a unit, a range and a meaning, described in one place. `space-foosball-match
// --train` searches over them.
//
// Lengths and speeds are in the team's frame: x from its own goal to the opponent's, 0 at the
// centre.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "vphysics/error.h"

namespace foosball {

struct Judgment {
  double shot_bar = 0.30;
  double patience = 0.8;
  double late = 0.5;
  double clear_power = 1.0;
  double clear_below = 0.25;
  double risk_cost = 1.5;
  double feint = 0.0;
  double keep_lane = 0.05;
  double feet_stay_up = 0.2;
  double far_worth = 0.10;
  double aim_belief = 0.0015;
  double pass_value = 0.12;
  double pass_sure = 0.75;
  double tame_speed = 1.6;
  double tame_approach = 0.6;
  double stop_first = 0.25;
  double soon = 0.20;
  double calm = 0.9;
  double still = 0.012;
  double turn_wait = 0.30;
  double turn_far = 0.060;
  double hands_ahead = 0.10;
  double hands_fast = 1.2;
  double hands_fast_within = 0.30;
  double hands_goalie = -0.45;
  double hands_defense = -0.15;
  double hands_midfield = 0.0;
  double hands_loose = 0.15;
  double hands_attack = 0.30;
  double men_keep_on = 0.6;
  double guard_path = 0.4;

  bool operator==(const Judgment&) const = default;
};

struct JudgmentField {
  const char* name;  // of the member
  const char* unit;  // empty: dimensionless
  double Judgment::*value;
  double min, max;
  const char* meaning;
};

inline constexpr std::array kJudgmentFields = std::to_array<JudgmentField>({
    {"shot_bar", "", &Judgment::shot_bar, 0.0, 0.9,
     "Worth (1: a sure goal) from which a shot is played at once."},
    {"patience", "s", &Judgment::patience, 0.1, 3.0, "The bar sinks to 0 in this time."},
    {"late", "s", &Judgment::late, 0.0, 2.0,
     "So long after that it strikes whatever the shot is worth."},
    {"clear_power", "", &Judgment::clear_power, 0.3, 1.0,
     "Share of the full strike for a ball that is only cleared."},
    {"clear_below", "", &Judgment::clear_below, 0.0, 0.9,
     "A stroke that is worth less is a clearance."},
    {"risk_cost", "", &Judgment::risk_cost, 0.0, 6.0, "Weight of a shot that may come back."},
    {"feint", "", &Judgment::feint, 0.0, 1.0, "Probability of a feint before a shot."},
    {"keep_lane", "", &Judgment::keep_lane, 0.0, 0.3,
     "Another lane must be worth more by this than the chosen one."},
    {"feet_stay_up", "", &Judgment::feet_stay_up, 0.0, 1.0,
     "Probability that men seen with their feet up still have them up when the ball comes."},
    {"far_worth", "", &Judgment::far_worth, -0.2, 0.5,
     "Worth of a ball that ends beside the opponent's goal."},
    {"aim_belief", "m", &Judgment::aim_belief, 0.0, 0.006,
     "The most aim error that it knows of itself: more, and edges of the foot look less sure."},
    {"pass_value", "", &Judgment::pass_value, 0.0, 1.0,
     "Worth of a ball at the foot of a man further ahead."},
    {"pass_sure", "", &Judgment::pass_sure, 0.3, 1.0,
     "Probability from which nobody in between is thought to reach a pass."},
    {"tame_speed", "m/s", &Judgment::tame_speed, 0.4, 4.0,
     "Faster balls are blocked, not taken under control."},
    {"tame_approach", "m/s", &Judgment::tame_approach, 0.1, 2.0,
     "The same of the speed towards its own goal."},
    {"stop_first", "m/s", &Judgment::stop_first, 0.02, 1.5,
     "The same where nobody stands behind: such a ball is stopped with the foot down first."},
    {"soon", "s", &Judgment::soon, 0.02, 0.8,
     "A ball that arrives within this time is followed closely."},
    {"calm", "m/s", &Judgment::calm, 0.1, 4.0,
     "A ball that rolls along the rods faster is not followed."},
    {"still", "m", &Judgment::still, 0.001, 0.05,
     "A hand at rest does not move for less than this."},
    {"turn_wait", "s", &Judgment::turn_wait, 0.0, 1.0,
     "A hand turns round no sooner after the last time."},
    {"turn_far", "m", &Judgment::turn_far, 0.010, 0.3, "... unless it has farther to go."},
    {"hands_ahead", "s", &Judgment::hands_ahead, 0.0, 0.4,
     "The hands choose rods for where the ball will be after this time."},
    {"hands_fast", "m/s", &Judgment::hands_fast, 0.3, 5.0,
     "A ball that comes faster calls both hands to the goal ..."},
    {"hands_fast_within", "m", &Judgment::hands_fast_within, -0.6, 0.6,
     "... if it is nearer than this to the own goal (x)."},
    {"hands_goalie", "m", &Judgment::hands_goalie, -0.6, 0.0,
     "Nearer (x) the goalie's rod comes first, then the defence."},
    {"hands_defense", "m", &Judgment::hands_defense, -0.6, 0.3,
     "Nearer the defence comes first, then the goalie."},
    {"hands_midfield", "m", &Judgment::hands_midfield, -0.3, 0.3,
     "Nearer the midfield comes first, then the goalie."},
    {"hands_loose", "m", &Judgment::hands_loose, -0.3, 0.6,
     "Nearer, at the opponent's midfield, defence and goalie."},
    {"hands_attack", "m", &Judgment::hands_attack, 0.0, 0.6,
     "Nearer the attack comes first, then the defence; farther, as the style has it."},
    {"men_keep_on", "", &Judgment::men_keep_on, 0.0, 1.0,
     "Share of its way that a rod that was seen to slide is thought to have gone on."},
    {"guard_path", "m/s", &Judgment::guard_path, 0.08, 2.0,
     "Men stand in the path of a ball that comes faster, and cover the goal from a slower one."},
});
inline constexpr int kJudgmentValues = static_cast<int>(kJudgmentFields.size());
static_assert(sizeof(Judgment) == sizeof(double) * kJudgmentValues, "a field is missing");

constexpr bool in_range(const JudgmentField& field, double value) {
  return field.min <= value && value <= field.max;
}
constexpr bool in_range(const Judgment& judgment) {
  bool all = true;
  for (const JudgmentField& f : kJudgmentFields) all = all && in_range(f, judgment.*f.value);
  return all;
}
static_assert(in_range(Judgment{}));

// Returns -1 if no value has this name.
constexpr int judgment_index(std::string_view name) {
  for (int i = 0; i < kJudgmentValues; ++i) {
    if (name == kJudgmentFields[static_cast<std::size_t>(i)].name) return i;
  }
  return -1;
}

// Applies changes such as "shot_bar=0.4,patience=1.2" to base. Fails with Errc::invalid_argument
// and a sentence for a name that is unknown or given twice and for a value out of range.
vp::Expected<Judgment> with_changes(const Judgment& base, std::string_view changes);
// The values that differ from base, as text. with_changes() reads it back bit for bit. Empty if
// nothing differs.
std::string changes_of(const Judgment& base, const Judgment& judgment);

}  // namespace foosball
