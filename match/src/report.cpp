#include "match/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "foosball/playability.h"

namespace match {
namespace {

using foosball::kTeams;
using foosball::Statistics;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string format(double value) {
  if (std::isnan(value)) return "-";
  char text[40];
  const double size = std::fabs(value);
  const char* digits = size >= 100.0                ? "%.0f"
                       : size >= 10.0               ? "%.1f"
                       : size >= 0.1 || size == 0.0 ? "%.2f"
                                                    : "%.3g";  // a length in metres
  std::snprintf(text, sizeof text, digits, value);
  return text;
}

struct Goal {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  std::string text{};
};
Goal at_most(double high, const std::string& text) {
  return {.high = high, .text = text};
}
Goal at_least(double low, const char* text) {
  return {.low = low, .text = text};
}

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? kNone : static_cast<double>(part) / static_cast<double>(whole);
}
double percent(std::uint64_t part, std::uint64_t whole) {
  return 100.0 * ratio(part, whole);
}

class List {
 public:
  explicit List(std::string section) : section_(std::move(section)) {}
  void add(const char* name, double value, const char* unit) {
    figures.push_back({section_, name, value, unit, "", Figure::Judgment::none});
  }
  void add(const char* name, double value, const char* unit, const Goal& goal) {
    const Figure::Judgment judgment = goal.text.empty()   ? Figure::Judgment::none
                                      : std::isnan(value) ? Figure::Judgment::unknown
                                      : value >= goal.low && value <= goal.high
                                          ? Figure::Judgment::pass
                                          : Figure::Judgment::falls_short;
    figures.push_back({section_, name, value, unit, goal.text, judgment});
  }
  // Of a share of n, each by itself [%]. One more of either kind is counted for the error, so that
  // three of three are not exact (Agresti and Coull).
  void add_share(const char* name, std::uint64_t part, std::uint64_t n, const Goal& goal) {
    add(name, percent(part, n), "%", goal);
    if (n == 0) return;
    const double p = ratio(part + 1, n + 2);
    figures.back().error = 100.0 * std::sqrt(p * (1.0 - p) / static_cast<double>(n + 2));
  }
  std::vector<Figure> figures;

 private:
  std::string section_;
};

template <class Counts>
std::uint64_t sum(const Counts& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}
double minutes(std::uint64_t ticks) {
  return static_cast<double>(ticks) * foosball::kTick / 60.0;
}
double per_minute(std::uint64_t count, std::uint64_t ticks) {
  return ticks == 0 ? kNone : static_cast<double>(count) / minutes(ticks);
}
template <class Histogram>
double quantile(const Histogram& histogram, double fraction) {
  return histogram.count() == 0 ? kNone : histogram.quantile(fraction);
}

void add_goals(List& list, const Statistics& s) {
  const std::uint64_t goals = sum(s.goals);
  list.add("goals a minute of play", per_minute(goals, s.play_ticks), "");
  list.add_share("own goals by swing, of all goals", sum(s.own_goals_swing), goals,
                 at_most(3.0, "below 3"));
  list.add_share("own goals by deflection, of all goals", sum(s.own_goals_deflected), goals, {});
  const std::uint64_t served = sum(s.goals_of_server) + sum(s.goals_of_receiver);
  list.add_share("the server scores next", sum(s.goals_of_server), served,
                 {48.0, 52.0, "48 to 52"});
}

void add_hands(List& list, const Statistics& s) {
  for (int team = 0; team < kTeams; ++team) {
    const auto& moving = s.moving_ticks[team];
    list.add(
        team == 0 ? "team 0 moves 3 rods or more at once" : "team 1 moves 3 rods or more at once",
        percent(moving[3] + moving[4], sum(moving)), "% of play", at_most(0.5, "none (two hands)"));
  }
  const double rod_seconds = foosball::kRods * static_cast<double>(s.play_ticks) * foosball::kTick;
  const double slide = static_cast<double>(sum(s.slide_reversals)) / rod_seconds;
  const double swing = static_cast<double>(sum(s.swing_reversals)) / rod_seconds;
  list.add("reversals a rod and second", slide + swing, "1/s", at_most(2.0, "at most 2"));
  list.add("  of the slide", slide, "1/s");
  list.add("  of the swing", swing, "1/s");
  const double held = static_cast<double>(sum(s.hand_ticks)) * foosball::kTick / rod_seconds;
  list.add("  of a rod while a hand holds it", held > 0.0 ? (slide + swing) / held : 0.0, "1/s");
  list.add("spins beyond a turn", per_minute(sum(s.spins), s.play_ticks), "a minute",
           at_most(0.0, "none"));
}

void add_ball(List& list, const Statistics& s) {
  list.add("hop, median", 1e3 * quantile(s.hop_height, 0.5), "mm", {20.0, 45.0, "30 (20 to 45)"});
  list.add("hop, 90th percentile", 1e3 * quantile(s.hop_height, 0.9), "mm",
           {80.0, 160.0, "120 (80 to 160)"});
  list.add("bounce, height after to before, median", 100.0 * quantile(s.bounce_ratio, 0.5), "%");
  list.add("fouls", per_minute(s.fouls, s.play_ticks), "a minute");
  list.add("balls out", per_minute(s.balls_out, s.play_ticks), "a minute",
           at_most(1.0, "at most 1"));
  list.add("nobody can reach the ball", percent(s.unreachable_ticks, s.ball_ticks), "% of ball",
           at_most(10.0, "below 10"));
  // By the rules that the matches are played by: a ball out of reach is dead after so long, one in
  // reach that nobody plays on after so long.
  const foosball::Rules rules = foosball::arcade_rules();
  const auto within = [](double limit) {
    return at_most(limit + 0.1, "at most " + format(limit) + " (rule)");
  };
  list.add("  longest", static_cast<double>(s.longest_unreachable_ticks) * foosball::kTick, "s",
           within(rules.dead_ball_seconds));
  list.add("ball still", percent(s.still_ticks, s.ball_ticks), "% of ball");
  list.add("longest stuck", static_cast<double>(s.longest_stuck_ticks) * foosball::kTick, "s",
           within(rules.still_seconds > 0.0 ? rules.still_seconds : rules.possession_seconds));
  list.add("dead balls", per_minute(s.dead_balls, s.play_ticks), "a minute",
           at_most(1.0, "below 1"));
}

void add_play(List& list, const Statistics& s) {
  list.add("touches", per_minute(sum(s.touches), s.play_ticks), "a minute");
  list.add("passes", per_minute(sum(s.passes), s.play_ticks), "a minute");
  list.add("  to a chosen man", per_minute(sum(s.passes_meant), s.play_ticks), "a minute");
  list.add("    who was the next to touch it", percent(sum(s.passes_arrived), sum(s.passes_meant)),
           "%");
  list.add("shots", per_minute(sum(s.shots), s.play_ticks), "a minute");
  list.add("  speed, median", quantile(s.shot_speed, 0.5), "m/s");
  list.add("  speed, 99th percentile", quantile(s.shot_speed, 0.99), "m/s");
  list.add("  on target", percent(sum(s.shots_on_target), sum(s.shots)), "%");
  list.add("saves", per_minute(sum(s.saves), s.play_ticks), "a minute");
  list.add("rally, median changes of side", quantile(s.rally, 0.5), "");
  list.add("possession of team 0", percent(s.possession_ticks[0], sum(s.possession_ticks)), "%");
  const std::uint64_t decided = sum(s.wins);
  list.add("length of a match, median", quantile(s.length, 0.5), "s of play");
  list.add("changes of lead", ratio(s.lead_changes, s.matches()), "a match");
  list.add("matches not decided in time", percent(s.undecided, s.matches()), "%");
  list.add_share("team 1 wins", s.wins[1], decided, {});
  const double n = static_cast<double>(decided);
  const double z = n > 0 ? (static_cast<double>(s.wins[1]) - 0.5 * n) / std::sqrt(0.25 * n) : kNone;
  list.add("  from chance", z, "z", {-2.0, 2.0, "-2 to 2"});
}

const char* word(Figure::Judgment judgment) {
  switch (judgment) {
    case Figure::Judgment::none:
      return "";
    case Figure::Judgment::pass:
      return "pass";
    case Figure::Judgment::falls_short:
      return "short";
    case Figure::Judgment::unknown:
      return "no data";
  }
  return "";
}

std::string padded(const std::string& text, std::size_t width) {
  return text.size() >= width ? text : text + std::string(width - text.size(), ' ');
}
std::string right(const std::string& text, std::size_t width) {
  return text.size() >= width ? text : std::string(width - text.size(), ' ') + text;
}

std::string escaped(const std::string& text, bool json) {
  std::string out;
  for (const char c : text) {
    if (c == '"')
      out += json ? "\\\"" : "\"\"";
    else if (c == '\\' && json)
      out += "\\\\";
    else
      out += c;
  }
  return '"' + out + '"';
}

}  // namespace

std::vector<Figure> figures_of(const std::string& section, const Statistics& statistics) {
  List list(section);
  add_goals(list, statistics);
  add_hands(list, statistics);
  add_ball(list, statistics);
  add_play(list, statistics);
  const foosball::Playability p = foosball::playability_of(statistics);
  list.add("playability", p.total, "of 1");
  list.add("  rallies", p.rallies, "");
  list.add("  saves", p.saves, "");
  list.add("  somebody can act", p.reach, "");
  list.add("  surprise", p.surprise, "");
  list.add("  length", p.length, "");
  list.add("  flow", p.flow, "");
  return list.figures;
}

std::string as_table(const std::vector<Figure>& figures) {
  std::string text, section;
  for (const Figure& f : figures) {
    if (f.section != section) text += (text.empty() ? "" : "\n") + f.section + "\n";
    section = f.section;
    std::string line = "  " + padded(f.name, 44) + right(format(f.value), 8) + " " +
                       padded(std::isnan(f.error) ? "" : "+-" + format(f.error), 7) +
                       padded(f.unit, 11) + padded(f.goal, 24) + word(f.judgment);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string as_csv(const std::vector<Figure>& figures) {
  std::string text = "section,figure,value,standard error,unit,goal,judgment\n";
  for (const Figure& f : figures) {
    text += escaped(f.section, false) + ',' + escaped(f.name, false) + ',' +
            (std::isnan(f.value) ? "" : std::to_string(f.value)) + ',' +
            (std::isnan(f.error) ? "" : std::to_string(f.error)) + ',' + escaped(f.unit, false) +
            ',' + escaped(f.goal, false) + ',' + word(f.judgment) + '\n';
  }
  return text;
}

std::string as_json(const std::vector<Figure>& figures) {
  std::string text = "[\n";
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const Figure& f = figures[i];
    text += "  {\"section\": " + escaped(f.section, true) +
            ", \"figure\": " + escaped(f.name, true) +
            ", \"value\": " + (std::isnan(f.value) ? "null" : std::to_string(f.value)) +
            ", \"standard_error\": " + (std::isnan(f.error) ? "null" : std::to_string(f.error)) +
            ", \"unit\": " + escaped(f.unit, true) + ", \"goal\": " + escaped(f.goal, true) +
            ", \"judgment\": \"" + word(f.judgment) + "\"}" + (i + 1 < figures.size() ? "," : "") +
            "\n";
  }
  return text + "]\n";
}

// --- the report ----------------------------------------------------------------------------------

namespace {

// Behind them one of each character.
enum Part { kMain, kPaper, kPassive, kSpinner, kOneRod, kParts };

}  // namespace

std::vector<SeriesDesc> report_series(const ReportPlan& plan) {
  SeriesDesc base;
  base.players = {plan.home, plan.away};
  base.layout = plan.layout;
  base.seed = plan.seed;
  base.max_ticks = plan.max_ticks;
  base.max_games = plan.matches;
  base.tuning = plan.tuning;
  base.character_list = plan.character_list;
  std::vector<SeriesDesc> series(kParts, base);
  series[kPaper].layout = plan.layout == foosball::Layout::paper ? foosball::Layout::tournament
                                                                 : foosball::Layout::paper;
  series[kPassive].players[1] = "idle";
  series[kPassive].max_games = std::min<std::uint64_t>(plan.matches, 8);  // they are long
  series[kSpinner].players = {"spinner", plan.home};
  series[kOneRod].players = {"one-rod:" + plan.home, plan.away};
  // Each character against the others, half as many matches each: equal players.
  base.players[1] = plan.home;
  base.max_games = std::max<std::uint64_t>(2, plan.matches / 4 * 2);
  base.draw_characters = false;
  for (std::size_t c = 0; c < plan.character_list.size(); ++c) {
    base.characters = {static_cast<int>(c), kAnyOther};
    series.push_back(base);
  }
  return series;
}

std::vector<Figure> report_figures(const ReportPlan& plan, const std::vector<Series>& series) {
  const auto players = [&](Part part) {
    const SeriesDesc& desc = series[part].desc();
    return desc.players[0] + " against " + desc.players[1] + ", " +
           std::to_string(series[part].taken()) + " matches" +
           (desc.layout == foosball::Layout::paper ? ", paper layout" : ", tournament layout");
  };
  std::vector<Figure> all = figures_of(players(kMain), series[kMain].statistics());
  const auto append = [&](List& list) {
    all.insert(all.end(), list.figures.begin(), list.figures.end());
  };
  List paper(players(kPaper));
  for (Figure& f : figures_of(players(kPaper), series[kPaper].statistics())) {
    if (f.name == "the server scores next" || f.name == "team 1 wins" ||
        f.name == "  from chance" || f.name == "nobody can reach the ball" ||
        f.name == "own goals by swing, of all goals") {
      paper.figures.push_back(f);
    }
  }
  append(paper);

  List passive(players(kPassive));
  const Statistics& s = series[kPassive].statistics();
  passive.add("minutes of play", minutes(s.play_ticks), "");
  passive.add("goals", static_cast<double>(sum(s.goals)), "");
  passive.add("goals a minute", per_minute(sum(s.goals), s.play_ticks), "",
              at_least(1.0, "at least 1"));
  passive.add("ball still", percent(s.still_ticks, s.ball_ticks), "% of ball",
              at_most(30.0, "below 30"));
  append(passive);

  const auto score = [&](std::size_t part) {
    return series[part].taken() < 2 ? kNone : 100.0 * mean_score(series[part].pairs());
  };
  // With a pair lost and a pair won added: pairs that ended alike are few, not exact.
  const auto error = [&](std::size_t part) {
    PairCounts pairs = series[part].pairs();
    ++pairs.front();
    ++pairs.back();
    return series[part].taken() < 2 ? kNone : 100.0 * score_error(pairs);
  };
  const auto add_points = [&](List& list, const char* name, std::size_t part, const Goal& goal) {
    list.add(name, score(part), "% points", goal);
    list.figures.back().error = error(part);
  };
  List spinner(players(kSpinner));
  add_points(spinner, "points of the spinner", kSpinner, at_most(35.0, "at most 35"));
  append(spinner);
  List one(players(kOneRod));
  add_points(one, "points of the player with one rod", kOneRod, at_least(45.0, "half"));
  append(one);
  List characters("characters, each against all others, played by " + plan.home + ", " +
                  std::to_string(series[kParts].taken()) + " matches each");
  for (std::size_t c = 0; c < plan.character_list.size(); ++c) {
    add_points(characters, plan.character_list[c].name.c_str(), kParts + c,
               {40.0, 60.0, "40 to 60"});
  }
  append(characters);
  return all;
}

}  // namespace match
