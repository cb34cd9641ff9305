#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "load.h"

namespace rigid {
namespace {

std::string subject(const Figure& f) {
  return fmt::format("{}@{}", f.scene, f.rate);
}

const Figure* find(const std::vector<Figure>& figures, const std::string& at,
                   const std::string& engine) {
  for (const Figure& f : figures) {
    if (subject(f) == at && f.engine == engine && f.missing.empty()) return &f;
  }
  return nullptr;
}

std::optional<double> share_of_bullet(const std::vector<Figure>& figures, const Figure& f) {
  const Figure* bullet = find(figures, subject(f), kReference);
  if (!bullet || !f.missing.empty()) return {};
  const double of = share(f, *bullet);
  return of > 0.0 ? std::optional(of) : std::nullopt;
}

// Goals for Virtual Physics: upper bounds of its results.
struct Goal {
  const char* subject;
  const char* metric;
  double at_most;
  const char* unit;
};
constexpr Goal kGoals[] = {
    {"towers1120@1000", "step_median_us", 640, "us"},
    {"pyramid1128@1000", "step_median_us", 1000, "us"},
    {"pile1120@1000", "step_median_us", 1000, "us"},
    {"towers1120@60", "share_of_bullet", 0.31, ""},
    {"pyramid1128@60", "share_of_bullet", 0.33, ""},
    {"pile1120@60", "share_of_bullet", 0.24, ""},
    {"pile10k@60", "share_of_bullet", 0.17, ""},
    {"towers1120@60", "out_of_place", 0, "bodies"},
    {"towers1120@60", "penetration_mm", 5, "mm"},
    {"towers1120@60", "drift_mm", 5, "mm"},
    {"pyramid1128@60", "out_of_place", 0, "bodies"},
    {"pyramid1128@60", "penetration_mm", 5, "mm"},
    {"pyramid1128@60", "drift_mm", 5, "mm"},
    {"towers1120@240", "out_of_place", 0, "bodies"},
    {"towers1120@240", "penetration_mm", 1, "mm"},
    {"towers1120@240", "drift_mm", 1, "mm"},
    {"pyramid1128@240", "out_of_place", 0, "bodies"},
    {"pyramid1128@240", "penetration_mm", 1, "mm"},
    {"pyramid1128@240", "drift_mm", 1, "mm"},
    {"towers1120@1000", "out_of_place", 0, "bodies"},
    {"towers1120@1000", "penetration_mm", 1, "mm"},
    {"towers1120@1000", "drift_mm", 1, "mm"},
    {"pyramid1128@1000", "out_of_place", 0, "bodies"},
    {"pyramid1128@1000", "penetration_mm", 1, "mm"},
    {"pyramid1128@1000", "drift_mm", 1, "mm"},
    {"ragdolls@60", "share_of_bullet", 0.50, ""},
    {"chain200@60", "share_of_bullet", 0.50, ""},
    {"bridge@60", "share_of_bullet", 0.50, ""},
    {"joint_grid@60", "share_of_bullet", 0.25, ""},
    {"rain@60", "share_of_bullet", 0.25, ""},
    {"trees100@60", "share_of_bullet", 0.05, ""},
    {"trees25@60", "share_of_bullet", 0.05, ""},
    {"washer@60", "share_of_bullet", 0.15, ""},
    {"convex_pile@60", "share_of_bullet", 0.20, ""},
    {"junkyard@60", "share_of_bullet", 0.12, ""},
    {"large_pyramid@60", "share_of_bullet", 0.15, ""},
    {"shaken_pyramid@60", "share_of_bullet", 0.20, ""},
    {"stirred_pile@60", "share_of_bullet", 0.25, ""},
    {"table1@1000", "step_median_us", 10, "us"},
    // The exponent of n log n between 1,000 and 100,000: 1 + log(log 100,000 / log 1,000) /
    // log 100.
    {"heaps@60", "growth_exponent", 1.11, ""},
};

struct Row {
  std::string metric, value, unit;
};

// Drift is reported if "in place" refers to the initial positions; the gap, if there are joints.
std::vector<Row> rows_of(const std::vector<Figure>& figures, const Figure& f) {
  if (!f.missing.empty()) {
    std::string why = f.missing;
    std::replace(why.begin(), why.end(), ',', ';');
    return {{"missing", why, ""}};
  }
  const auto scene = load(f.scene).value();
  const scenes::Standing& s = f.standing;
  std::vector<Row> rows = {{"step_median_us", fmt::format("{:.5g}", f.median_us), "us"},
                           {"step_p99_us", fmt::format("{:.5g}", f.p99_us), "us"}};
  const auto add = [&](const char* metric, const std::string& value, const std::string& unit) {
    rows.push_back({metric, value, unit});
  };
  if (f.runs > 1) add("runs", std::to_string(f.runs), "");
  if (f.settled_us > 0.0) add("step_settled_us", fmt::format("{:.5g}", f.settled_us), "us");
  if (const auto share = share_of_bullet(figures, f); share && f.engine != kReference) {
    add("share_of_bullet", fmt::format("{:.4g}", *share), "");
  }
  add("in_place", std::to_string(s.in_place), fmt::format("of {}", s.of));
  add("penetration_mm", fmt::format("{:.4g}", 1e3 * s.penetration), "mm");
  if (scene.in_place.rule == scenes::InPlace::Rule::near_start) {
    add("drift_mm", fmt::format("{:.4g}", 1e3 * s.drift), "mm");
    add("sink_mm", fmt::format("{:.3g}", 1e3 * s.sink), "mm");
  }
  if (!scene.joints.empty()) add("joint_gap_mm", fmt::format("{:.3g}", 1e3 * s.gap), "mm");
  if (f.fastest >= 0.0) add("fastest_m_s", fmt::format("{:.3g}", f.fastest), "m/s");
  if (f.bits_as_native && f.engine != kOurs) add("bits_as_native", "1", "");
  add("rss_mb", fmt::format("{:.0f}", f.rss_mb), "MB");
  add("simulated_s", fmt::format("{:.4g}", f.simulated), fmt::format("of {:g} s", scene.seconds));
  return rows;
}

bool is_our_heap(const Figure& f) {
  return f.engine == kOurs && f.scene.starts_with("heap");
}

// The exponent p of the power n^p that best fits the cost of heaps of n boxes at rest: a linear fit
// of the logarithms.
std::optional<double> growth_exponent(const std::vector<Figure>& figures) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const Figure& f : figures) {
    if (!is_our_heap(f)) continue;
    if (f.settled_us <= 0.0) return {};  // no fit without the heaps that did not finish
    const double u = std::log(std::stod(f.scene.substr(4))), v = std::log(f.settled_us);
    n += 1.0, x += u, y += v, xx += u * u, xy += u * v;
  }
  if (n < 3.0) return {};
  return (n * xy - x * y) / (n * xx - x * x);
}

std::optional<double> reached(const std::vector<Figure>& figures, const Goal& goal) {
  const std::string metric = goal.metric;
  if (metric == "growth_exponent") return growth_exponent(figures);
  const Figure* ours = find(figures, goal.subject, kOurs);
  if (!ours) return {};
  if (metric == "step_median_us") return ours->median_us;
  if (metric == "share_of_bullet") return share_of_bullet(figures, *ours);
  if (metric == "out_of_place") return ours->standing.of - ours->standing.in_place;
  return 1e3 * (metric == "drift_mm" ? ours->standing.drift : ours->standing.penetration);
}

// Whether the scenes and engines of the goal were run. If so, the goal is reported, even without
// results.
bool concerns(const std::vector<Figure>& figures, const Goal& goal) {
  const std::string_view metric = goal.metric;
  if (metric == "growth_exponent") {
    return std::count_if(figures.begin(), figures.end(), is_our_heap) >= 3;
  }
  const auto ran = [&](const char* engine) {
    return std::any_of(figures.begin(), figures.end(), [&](const Figure& f) {
      return f.engine == engine && subject(f) == goal.subject;
    });
  };
  return ran(kOurs) && (metric != "share_of_bullet" || ran(kReference));
}

// The note after an engine's row.
std::string note_on(const Figure& f) {
  if (f.stopped()) return "  " + f.ended;
  return f.bits_as_native && f.engine != kOurs ? "  the native program's bits" : "";
}

// The value of a metric, or "-".
std::string cell(const std::vector<Row>& rows, const char* metric) {
  for (const Row& row : rows) {
    if (row.metric == metric) return row.value;
  }
  return "-";
}

}  // namespace

std::string table(const std::vector<Figure>& figures) {
  if (figures.empty()) return {};
  const auto scene = load(figures[0].scene).value();
  std::string out = fmt::format("\n{} at {} Hz, {} bodies, {:g} s\n", figures[0].scene,
                                figures[0].rate, scene.bodies.size(), scene.seconds);
  out += fmt::format("  {:<30}{:>11}{:>11}{:>8}{:>10}{:>10}{:>11}{:>9}{:>9}{:>8}{:>9}\n", "",
                     "median us", "p99 us", "/Bullet", "in place", "pen. mm", "drift mm", "gap mm",
                     "m/s", "MB", "until s");
  for (const Figure& f : figures) {
    if (!f.missing.empty()) {
      out += fmt::format("  {:<30}{}\n", f.engine, f.missing);
      continue;
    }
    const auto rows = rows_of(figures, f);
    out += fmt::format("  {:<30}{:>11}{:>11}{:>8}{:>10}{:>10}{:>11}{:>9}{:>9}{:>8}{:>9}{}\n",
                       f.engine, cell(rows, "step_median_us"), cell(rows, "step_p99_us"),
                       cell(rows, "share_of_bullet"), cell(rows, "in_place"),
                       cell(rows, "penetration_mm"), cell(rows, "drift_mm"),
                       cell(rows, "joint_gap_mm"), cell(rows, "fastest_m_s"), cell(rows, "rss_mb"),
                       cell(rows, "simulated_s"), note_on(f));
  }
  return out;
}

std::string goals_table(const std::vector<Figure>& figures) {
  std::string out;
  for (const Goal& goal : kGoals) {
    if (!concerns(figures, goal)) continue;
    const auto value = reached(figures, goal);
    out += fmt::format("  {:<18}{:<18}{:>10}{:>10g} {:<7}{}\n", goal.subject, goal.metric,
                       value ? fmt::format("{:.4g}", *value) : "-", goal.at_most, goal.unit,
                       value && *value <= goal.at_most ? "met" : "short");
  }
  if (out.empty()) return out;
  return fmt::format("\n  {:<36}{:>10}{:>10}\n", "goal, at most", "reached", "goal") + out;
}

std::string csv(const std::vector<Figure>& figures) {
  std::string out = "subject,engine,metric,value,unit\n";
  for (const Figure& f : figures) {
    for (const Row& row : rows_of(figures, f)) {
      out += fmt::format("{},{},{},{},{}\n", subject(f), f.engine, row.metric, row.value, row.unit);
    }
  }
  for (const Goal& goal : kGoals) {
    if (!concerns(figures, goal)) continue;
    const auto value = reached(figures, goal);
    const std::string_view metric = goal.metric;
    if (value && (metric == "out_of_place" || metric == "growth_exponent")) {
      out +=
          fmt::format("{},{},{},{:.4g},{}\n", goal.subject, kOurs, goal.metric, *value, goal.unit);
    }
    out += fmt::format("{},goal,{},{:g},{}\n", goal.subject, goal.metric, goal.at_most, goal.unit);
  }
  return out;
}

}  // namespace rigid
