#include "match/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <span>

#include "foosball/computer_player.h"
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
                                                    : "%.3g";  // for lengths in metres
  std::snprintf(text, sizeof text, digits, value);
  return text;
}

// A goal is printed with exactly the digits of the number that is compared.
std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}
std::string with_note(const std::string& text, const char* note) {
  return *note == 0 ? text : text + " (" + note + ")";
}
struct Goal {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  std::string text{};  // empty: no goal
};
Goal at_most(double high, const char* note = "") {
  return {.high = high, .text = with_note("at most " + number(high), note)};
}
Goal at_least(double low, const char* note = "") {
  return {.low = low, .text = with_note("at least " + number(low), note)};
}
Goal within(double low, double high) {
  return {low, high, number(low) + " to " + number(high)};
}
Goal around(double value, double low, double high) {
  return {low, high, with_note(number(value), within(low, high).text.c_str())};
}

// open: a bound is within two standard errors of the value, so that chance may decide.
Figure::Judgment judge(const Goal& goal, double value, double error) {
  if (goal.text.empty()) return Figure::Judgment::none;
  if (std::isnan(value)) return Figure::Judgment::unknown;
  const double doubt = std::isnan(error) ? -1.0 : 2.0 * error;
  if (std::fabs(value - goal.low) <= doubt || std::fabs(value - goal.high) <= doubt)
    return Figure::Judgment::open;
  return value >= goal.low && value <= goal.high ? Figure::Judgment::pass
                                                 : Figure::Judgment::falls_short;
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
  // error: standard error of the value, if known.
  void add(const char* name, double value, const char* unit, const Goal& goal,
           double error = kNone) {
    figures.push_back({section_, name, value, unit, goal.text, judge(goal, value, error), error});
  }
  // A fraction of n independent cases [%]. The error counts one more case of either kind, so that
  // three of three do not count as exact (Agresti and Coull).
  void add_share(const char* name, std::uint64_t part, std::uint64_t n, const Goal& goal) {
    const double p = ratio(part + 1, n + 2);
    const double error = 100.0 * std::sqrt(p * (1.0 - p) / static_cast<double>(n + 2));
    add(name, percent(part, n), "%", goal, n == 0 ? kNone : error);
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
  list.add_share("own goals by swing, of all goals", sum(s.own_goals_swing), goals, at_most(3.0));
  list.add_share("own goals by deflection, of all goals", sum(s.own_goals_deflected), goals, {});
  const std::uint64_t served = sum(s.goals_of_server) + sum(s.goals_of_receiver);
  list.add_share("the server scores next", sum(s.goals_of_server), served, within(48.0, 52.0));
}

void add_hands(List& list, const Statistics& s) {
  for (int team = 0; team < kTeams; ++team) {
    const auto& moving = s.moving_ticks[team];
    list.add(
        team == 0 ? "team 0 moves 3 rods or more at once" : "team 1 moves 3 rods or more at once",
        percent(moving[3] + moving[4], sum(moving)), "% of play", at_most(0.5, "two hands"));
  }
  const double rod_seconds = foosball::kRods * static_cast<double>(s.play_ticks) * foosball::kTick;
  const double slide = static_cast<double>(sum(s.slide_reversals)) / rod_seconds;
  const double swing = static_cast<double>(sum(s.swing_reversals)) / rod_seconds;
  list.add("reversals a rod and second", slide + swing, "1/s", at_most(2.0));
  list.add("  of the slide", slide, "1/s");
  list.add("  of the swing", swing, "1/s");
  const double held = static_cast<double>(sum(s.hand_ticks)) * foosball::kTick / rod_seconds;
  list.add("  of a rod while a hand holds it", held > 0.0 ? (slide + swing) / held : 0.0, "1/s");
  list.add("spins beyond a turn", per_minute(sum(s.spins), s.play_ticks), "a minute", at_most(0.0));
}

// The limits are those of the matches' rules: a ball out of reach becomes dead after this time, and
// so does a ball within reach that nobody plays.
void add_longest(List& list, const Statistics& s, const char* name) {
  list.add(name, static_cast<double>(s.longest_unreachable_ticks) * foosball::kTick, "s",
           at_most(foosball::arcade_rules().dead_ball_seconds, "rule"));
}
void add_longest_stuck(List& list, const Statistics& s) {
  list.add("longest stuck", static_cast<double>(s.longest_stuck_ticks) * foosball::kTick, "s",
           at_most(foosball::arcade_rules().still_seconds, "rule"));
}

void add_ball(List& list, const Statistics& s) {
  list.add("hop, median", 1e3 * quantile(s.hop_height, 0.5), "mm", around(30.0, 20.0, 45.0));
  list.add("hop, 90th percentile", 1e3 * quantile(s.hop_height, 0.9), "mm",
           around(120.0, 80.0, 160.0));
  list.add("bounce, height after to before, median", 100.0 * quantile(s.bounce_ratio, 0.5), "%");
  list.add("fouls", per_minute(s.fouls, s.play_ticks), "a minute");
  list.add("balls out", per_minute(s.balls_out, s.play_ticks), "a minute", at_most(1.0));
  list.add("nobody can reach the ball", percent(s.unreachable_ticks, s.ball_ticks), "% of ball",
           at_most(10.0));
  add_longest(list, s, "  longest");
  list.add("ball still", percent(s.still_ticks, s.ball_ticks), "% of ball");
  add_longest_stuck(list, s);
  list.add("dead balls", per_minute(s.dead_balls, s.play_ticks), "a minute", at_most(1.0));
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
  list.add("  from chance", z, "z", within(-2.0, 2.0));
}

const char* word(Figure::Judgment judgment) {
  switch (judgment) {
    case Figure::Judgment::none:
      return "";
    case Figure::Judgment::pass:
      return "pass";
    case Figure::Judgment::falls_short:
      return "short";
    case Figure::Judgment::open:
      return "open";
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

enum class Part { main, other_layout, passive, spinner, one_rod, characters };

// The useful series of the plan. A report of a player who has no hand, spins, or already has one
// rod omits those that are impossible or redundant.
std::vector<Part> parts_of(const ReportPlan& plan) {
  std::vector<Part> parts{Part::main, Part::other_layout};
  if (plan.home == "idle") return parts;
  if (plan.away != "idle") parts.push_back(Part::passive);
  if (plan.home != "spinner") parts.push_back(Part::spinner);
  if (!plan.home.starts_with("one-rod")) parts.push_back(Part::one_rod);
  parts.push_back(Part::characters);
  return parts;
}

SeriesDesc base_of(const ReportPlan& plan) {
  SeriesDesc base;
  base.players = {plan.home, plan.away};
  base.layout = plan.layout;
  base.seed = plan.seed;
  base.max_ticks = plan.max_ticks;
  base.max_games = plan.matches;
  base.tuning = plan.tuning;
  base.character_list = plan.character_list;
  return base;
}

foosball::Layout other(foosball::Layout layout) {
  return layout == foosball::Layout::paper ? foosball::Layout::tournament : foosball::Layout::paper;
}

// For every part except the characters.
SeriesDesc series_of(const ReportPlan& plan, Part part) {
  SeriesDesc desc = base_of(plan);
  if (part == Part::other_layout) desc.layout = other(plan.layout);
  if (part == Part::passive) {
    desc.players[1] = "idle";
    desc.max_games = std::min<std::uint64_t>(plan.matches, 8);  // these matches are long
  }
  if (part == Part::spinner) desc.players = {"spinner", plan.home};
  if (part == Part::one_rod) desc.players = {"one-rod:" + plan.home, plan.away};
  return desc;
}

std::string title(const Series& series) {
  const SeriesDesc& desc = series.desc();
  return desc.players[0] + " against " + desc.players[1] + ", " + std::to_string(series.taken()) +
         " matches" +
         (desc.layout == foosball::Layout::paper ? ", paper layout" : ", tournament layout");
}

void add_points(List& list, const char* name, const Series& series, const Goal& goal) {
  if (series.taken() < 2) return list.add(name, kNone, "% points", goal);
  // Adds a lost and a won pair for the error, so that a few pairs with the same result do not count
  // as exact.
  PairCounts pairs = series.pairs();
  ++pairs.front();
  ++pairs.back();
  list.add(name, 100.0 * mean_score(series.pairs()), "% points", goal, 100.0 * score_error(pairs));
}

List in_other_layout(const Series& series) {
  List list(title(series));
  for (Figure& f : figures_of(title(series), series.statistics())) {
    if (f.name == "the server scores next" || f.name == "team 1 wins" ||
        f.name == "  from chance" || f.name == "nobody can reach the ball" ||
        f.name == "own goals by swing, of all goals") {
      list.figures.push_back(f);
    }
  }
  return list;
}

List against_idle(const Series& series) {
  List list(title(series));
  const Statistics& s = series.statistics();
  list.add("minutes of play", minutes(s.play_ticks), "");
  list.add("goals", static_cast<double>(sum(s.goals)), "");
  list.add("goals a minute", per_minute(sum(s.goals), s.play_ticks), "", at_least(1.0));
  list.add("ball still", percent(s.still_ticks, s.ball_ticks), "% of ball", at_most(30.0));
  return list;
}

// One series per character.
List of_characters(const ReportPlan& plan, std::span<const Series> series) {
  List list("characters, each against all others, played by " + plan.home + ", " +
            std::to_string(series.front().taken()) + " matches each");
  for (std::size_t c = 0; c < plan.character_list.size(); ++c) {
    add_points(list, plan.character_list[c].name.c_str(), series[c], within(40.0, 60.0));
  }
  return list;
}

List list_of(const ReportPlan& plan, Part part, std::span<const Series> series) {
  const Series& first = series.front();
  List list(title(first));
  switch (part) {
    case Part::main:
      list.figures = figures_of(title(first), first.statistics());
      break;
    case Part::other_layout:
      return in_other_layout(first);
    case Part::passive:
      return against_idle(first);
    case Part::spinner:
      add_points(list, "points of the spinner", first, at_most(35.0));
      break;
    case Part::one_rod:
      add_points(list, "points of the player with one rod", first, at_least(50.0));
      break;
    case Part::characters:
      return of_characters(plan, series);
  }
  return list;
}

}  // namespace

std::vector<SeriesDesc> report_series(const ReportPlan& plan) {
  std::vector<SeriesDesc> series;
  for (const Part part : parts_of(plan)) {
    if (part != Part::characters) {
      series.push_back(series_of(plan, part));
      continue;
    }
    // Each character against the others, with half as many matches, between equal players.
    SeriesDesc desc = base_of(plan);
    desc.players[1] = plan.home;
    desc.max_games = std::max<std::uint64_t>(2, plan.matches / 4 * 2);
    desc.draw_characters = false;
    for (std::size_t c = 0; c < plan.character_list.size(); ++c) {
      desc.characters = {static_cast<int>(c), kAnyOther};
      series.push_back(desc);
    }
  }
  return series;
}

std::vector<Figure> report_figures(const ReportPlan& plan, const std::vector<Series>& series) {
  std::vector<Figure> all;
  std::span<const Series> left(series);
  for (const Part part : parts_of(plan)) {
    const std::vector<Figure> figures = list_of(plan, part, left).figures;
    all.insert(all.end(), figures.begin(), figures.end());
    left = left.subspan(part == Part::characters ? plan.character_list.size() : 1);
  }
  return all;
}

// --- stuck balls ---------------------------------------------------------------------------------

std::vector<SeriesDesc> stuck_ball_series(const ReportPlan& plan) {
  std::vector<SeriesDesc> series;
  for (const auto layout : {foosball::Layout::tournament, foosball::Layout::paper}) {
    for (int level = 1; level <= foosball::kLevels; ++level) {
      SeriesDesc desc = base_of(plan);
      desc.players.fill(std::to_string(level));
      desc.layout = layout;
      series.push_back(desc);
    }
  }
  return series;
}

std::vector<Figure> stuck_ball_figures(const std::vector<Series>& series) {
  std::vector<Figure> all;
  for (const Series& s : series) {
    List list(title(s));
    list.add("minutes of play", minutes(s.statistics().play_ticks), "");
    add_longest(list, s.statistics(), "longest out of reach");
    add_longest_stuck(list, s.statistics());
    list.add("dead balls", static_cast<double>(s.statistics().dead_balls), "");
    all.insert(all.end(), list.figures.begin(), list.figures.end());
  }
  return all;
}

bool any_short(const std::vector<Figure>& figures) {
  return std::ranges::any_of(
      figures, [](const Figure& f) { return f.judgment == Figure::Judgment::falls_short; });
}

}  // namespace match
