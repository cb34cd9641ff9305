#include "render/match_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "foosball/play_style.h"
#include "foosball/rules.h"
#include "foosball/table.h"
#include "render/hud_screens.h"
#include "render/sentences.h"
#include "render/translate.h"

namespace client {
namespace {

constexpr float kHurries = 5.0f;     // [s]
constexpr float kFoulShown = 4.0f;   // [s]
constexpr float kServeShown = 1.5f;  // [s] of play

std::string joined(const std::vector<std::string>& parts, const char* between) {
  std::string text;
  for (const std::string& part : parts) {
    if (part.empty()) continue;
    if (!text.empty()) text += between;
    text += part;
  }
  return text;
}

template <class Number>
std::string pair_text(const std::array<Number, 2>& numbers, std::size_t left, const char* between) {
  return std::to_string(numbers[left]) + between + std::to_string(numbers[1 - left]);
}

bool shows(const wire::Snapshot& state, wire::Mode mode) {
  return state.mode == number(mode) && !state.attract;
}

std::string serve_text(int team) {
  return std::string(tr("Serve")) + ": " + team_with_mark(team);
}

std::string foul_text(const wire::Snapshot& state) {
  constexpr std::array<const char*, 6> kFouls{N_("held too long"),    N_("spinning"),
                                              N_("jarring"),          N_("technical foul"),
                                              N_("time-out misused"), N_("faulty serve")};
  const char* foul = kFouls[std::min<std::size_t>(state.last_foul, kFouls.size() - 1)];
  return std::string(tr("Foul")) + ": " + team_with_mark(state.last_foul_team) + ", " + tr(foul);
}

std::string time_out_text(const wire::Snapshot& state) {
  char left[24];
  std::snprintf(left, sizeof left, " %.0f s", static_cast<double>(state.time_out_seconds));
  return std::string(tr("Time-out")) + ": " + team_with_mark(state.time_out_team) + left;
}

std::string last_shot_text(const wire::ShotSnapshot& shot) {
  char text[48];
  std::snprintf(text, sizeof text, ": %.1f m/s, %.0f°", static_cast<double>(shot.speed),
                57.29578 * static_cast<double>(shot.angle));
  return std::string(tr("Last shot")) + text;
}

// --- the ladder ----------------------------------------------------------------------------------

std::string opponent_text(int rung) {
  constexpr std::array<const char*, foosball::kPlayStyles> kStyles{N_("wall"), N_("shooter"),
                                                                   N_("passer"), N_("gambler")};
  const int level = foosball::level_of_rung(std::clamp(rung, 0, foosball::kLadderRungs - 1));
  const auto style = static_cast<std::size_t>(foosball::style_of_level(level));
  return filled(tr("level %1, %2"), {std::to_string(level), tr(kStyles[style])});
}

std::string rung_text(int rung) {
  return filled(tr("Rung %1 of %2"),
                {std::to_string(rung + 1), std::to_string(foosball::kLadderRungs)});
}

// The climber has won the match at this rung.
bool has_climbed(const wire::Snapshot& state) {
  if (!shows(state, wire::Mode::ladder)) return false;
  const std::size_t person = state.computer[0] && !state.computer[1] ? 1 : 0;
  return state.sets[person] > state.sets[1 - person];
}

// The man who is served the ball in training.
std::string feed_text(const wire::Snapshot& state) {
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(state.layout));
  const std::size_t rod = std::min<std::size_t>(state.feed_rod, foosball::kRods - 1);
  return std::string(tr("Ball for")) + ": " + team_with_mark(table.rods[rod].team) + ", " +
         line_name(state.layout, static_cast<int>(rod)) + " " + std::to_string(state.feed_man + 1);
}

}  // namespace

std::string team_with_mark(int team) {
  const std::size_t t = team == 1 ? 1 : 0;
  return std::string(kTeamMark[t]).append(" ").append(kTeamNames[t]);
}

std::string line_name(int layout, int rod) {
  constexpr std::array<const char*, 4> kLines{N_("Goalie"), N_("Defence"), N_("Midfield"),
                                              N_("Attack")};
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(layout));
  const auto& spec = table.rods[static_cast<std::size_t>(std::clamp(rod, 0, foosball::kRods - 1))];
  return tr(kLines[static_cast<std::size_t>(spec.line)]);
}

// The server reports the side in possession. The rod is the nearest one of that side. Halfway to
// the next rod no clock runs.
std::optional<PossessionClock> possession_clock(const wire::Snapshot& state) {
  const bool runs = state.screen == number(wire::Screen::play) && state.ball_in_play &&
                    state.time_out_seconds <= 0.0f && !shows(state, wire::Mode::training);
  if (!runs) return std::nullopt;
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(state.layout));
  const int team = state.possession_team == 1 ? 1 : 0;
  const double ball = state.ball.position[0];
  const foosball::RodSpec* nearest = nullptr;
  const auto off = [ball](const foosball::RodSpec& rod) { return std::fabs(rod.x - ball); };
  for (const foosball::RodSpec& rod : table.rods) {
    if (rod.team == team && (nearest == nullptr || off(rod) < off(*nearest))) nearest = &rod;
  }
  if (nearest == nullptr) return std::nullopt;
  const double between = table.rods[1].x - table.rods[0].x;
  // Behind the goalie there is no other rod.
  const bool behind = nearest->line == foosball::Line::goalie;
  if (!behind && off(*nearest) > 0.5 * between) return std::nullopt;
  const bool tournament = state.rule_set == number(wire::RuleSet::itsf);
  const foosball::Rules rules = tournament ? foosball::itsf_rules() : foosball::arcade_rules();
  const auto limit = static_cast<float>(
      foosball::possession_limit(rules, nearest->line == foosball::Line::midfield));
  const float left = std::max(0.0f, limit - state.possession_seconds);
  const bool hurries = left <= kHurries;
  if (!tournament && !hurries) return std::nullopt;
  return PossessionClock{team, static_cast<int>(std::ceil(left)), hurries};
}

std::string rules_line(const HudState& hud) {
  const wire::Snapshot& state = *hud.state;
  if (state.time_out_seconds > 0.0f) return time_out_text(state);
  const bool training = shows(state, wire::Mode::training);
  const bool serve = !training && (!state.ball_in_play || hud.since_serve < kServeShown);
  std::vector<std::string> parts;
  if (state.fouled && hud.since_foul < kFoulShown) parts.push_back(foul_text(state));
  if (serve) parts.push_back(serve_text(state.next_server));
  if (state.golden_goal) parts.emplace_back(tr("golden goal: the next one decides"));
  if (training) parts.push_back(feed_text(state));
  if (training && state.last_shot.speed > 0.0f) parts.push_back(last_shot_text(state.last_shot));
  return joined(parts, "  -  ");
}

// The end of a set names its winner; if the ball is in no goal, the time has ended it.
CeremonyText ceremony_text(const HudState& hud) {
  const wire::Snapshot& state = *hud.state;
  const std::size_t winner = state.last_scorer == 1 ? 1 : 0;
  const std::string name = team_with_mark(state.last_scorer);
  if (!stopped_for_goal(state)) {
    return {tr("TIME"), filled(tr("Set for %1"), {name}),
            pair_text(state.score, winner, " : ") + ", " + tr("sets") + " " +
                pair_text(state.sets, winner, " : ")};
  }
  const GoalStory& goal = hud.goal;
  CeremonyText text;
  text.call = goal.own_goal ? tr("OWN GOAL") : state.golden_goal ? tr("GOLDEN GOAL") : tr("GOAL");
  if (hud.set_over) {
    text.line = filled(tr("Goal and set for %1"), {name});
  } else {
    text.line = std::string(tr("Goal for")) + " " + name;
    // (5) The side that conceded.
    if (!shows(state, wire::Mode::training))
      text.line += "  -  " + serve_text(1 - static_cast<int>(winner));
  }
  if (goal.scorer_rod >= 0) {
    char speed[32];
    std::snprintf(speed, sizeof speed, ", %.1f m/s", static_cast<double>(goal.speed));
    const std::size_t of = goal.own_goal ? 1 - winner : winner;
    text.detail = team_with_mark(static_cast<int>(of)) + ", " +
                  line_name(state.layout, goal.scorer_rod) + " " +
                  std::to_string(goal.scorer_man + 1) + speed;
  }
  return text;
}

EndText end_text(const HudState& hud, std::size_t left) {
  const wire::Snapshot& state = *hud.state;
  const bool drawn = state.score[0] == state.score[1];  // only if the time was over
  EndText text;
  text.title = drawn ? tr("A DRAW") : team_with_mark(state.last_scorer) + " " + tr("WINS");
  text.call = tr("push a rod to play again");
  const bool in_sets = state.sets[0] + state.sets[1] > 1;
  for (std::size_t team = 0; team < 2; ++team)
    text.result[team] = in_sets ? state.sets[team] : state.score[team];
  if (in_sets) {
    std::vector<std::string> sets;
    for (const std::array<int, 2>& set : hud.sets) sets.push_back(pair_text(set, left, ":"));
    // A client that joined late has not observed all of them.
    const bool all = sets.size() == static_cast<std::size_t>(state.sets[0] + state.sets[1]);
    text.details.push_back(all ? std::string(tr("sets")) + "  " + joined(sets, "   ")
                               : std::string(tr("last set")) + " " +
                                     pair_text(state.score, left, ":"));
  }
  if (!has_climbed(state)) return text;
  if (state.rung + 1 < foosball::kLadderRungs) {
    text.call =
        tr("push a rod for the next rung") + std::string(": ") + opponent_text(state.rung + 1);
  } else {
    text.title = tr("CHAMPION OF THE LADDER");
    text.details.push_back(
        filled(tr("%1 has beaten every opponent"), {team_with_mark(state.last_scorer)}));
  }
  return text;
}

std::array<std::string, 2> mode_lines(const wire::Snapshot& state, std::size_t left) {
  if (shows(state, wire::Mode::ladder)) return {rung_text(state.rung), opponent_text(state.rung)};
  if (!shows(state, wire::Mode::challenge)) return {};
  const int seconds = static_cast<int>(std::ceil(std::clamp(state.seconds_left, 0.0f, 3600.0f)));
  char clock[24];
  std::snprintf(clock, sizeof clock, "%d:%02d", seconds / 60, seconds % 60);
  return {tr("Challenge of the day"),
          filled(tr("%1 left, goals %2"), {clock, pair_text(state.score, left, " : ")})};
}

}  // namespace client
