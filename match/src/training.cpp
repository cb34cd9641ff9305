#include "match/training.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "foosball/computer_player.h"
#include "match/player.h"

namespace match {
namespace {

using foosball::Judgment;
using foosball::JudgmentField;
using foosball::kJudgmentFields;

constexpr std::array kLayouts{foosball::Layout::tournament, foosball::Layout::paper};

// Distance between the seeds of the generations and of the validation.
constexpr std::uint64_t kSeedsApart = 100'000;

double share_of(const JudgmentField& field, double value) {
  return (value - field.min) / (field.max - field.min);
}

// Four digits are finer than any search can resolve. So a sample's name contains its complete
// value.
double value_at(const JudgmentField& field, double share) {
  const double value = std::lerp(field.min, field.max, std::clamp(share, 0.0, 1.0));
  char digits[32];
  const int size = std::snprintf(digits, sizeof digits, "%.4g", value);
  double rounded = value;
  std::from_chars(digits, digits + size, rounded);
  return std::clamp(rounded, field.min, field.max);
}

// Goals of the first and the second player. Half a goal each defines the fraction without goals.
struct Goals {
  double own = 0.5, other = 0.5;
  void add(const Series& series) {
    own += static_cast<double>(series.goals()[0]);
    other += static_cast<double>(series.goals()[1]);
  }
  double share() const { return own / (own + other); }
  // Assumes independent goals.
  double error() const { return std::sqrt(share() * (1.0 - share()) / (own + other)); }
};

// Every opponent and layout has the same weight, regardless of its number of goals.
struct MeanShare {
  double value = 0.0, error = 0.0;
};
MeanShare mean_share(const std::vector<Goals>& kinds) {
  MeanShare mean;
  for (const Goals& goals : kinds) {
    mean.value += goals.share();
    mean.error += goals.error() * goals.error();
  }
  const double n = static_cast<double>(kinds.size());
  return {mean.value / n, std::sqrt(mean.error) / n};
}

std::vector<SeriesDesc> in_both_layouts(SeriesDesc desc) {
  std::vector<SeriesDesc> all;
  for (const auto layout : kLayouts) {
    desc.layout = layout;
    all.push_back(desc);
  }
  return all;
}

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// The two values of a field that the screening compares.
std::array<double, 2> low_and_high(const TrainPlan& plan, std::size_t index,
                                   const Judgment& start) {
  const JudgmentField& field = kJudgmentFields[index];
  const double at = share_of(field, start.*field.value);
  return {value_at(field, at - plan.step), value_at(field, at + plan.step)};
}

// Points of the design: the rows of the Hadamard matrix whose size is the smallest power of 2 above
// the number of fields, then the same rows with exchanged signs.
std::size_t design_points(const TrainPlan& plan) {
  return 2 * std::bit_ceil(plan.fields.size() + 1);
}
bool is_high(const TrainPlan& plan, std::size_t point, std::size_t field) {
  const std::size_t rows = design_points(plan) / 2;
  const bool odd = std::popcount((point % rows) & (field + 1)) % 2 == 1;
  return odd != (point >= rows);
}

}  // namespace

std::string TrainPlan::text() const {
  std::string text = "training of " + player + " against";
  for (const std::string& opponent : opponents) text += " " + opponent;
  text += ": ";
  for (const std::size_t field : fields) text += std::string(kJudgmentFields[field].name) + " ";
  return text + std::to_string(population) + " " + std::to_string(generations) + " " +
         std::to_string(step) + " " + std::to_string(matches) + " " + std::to_string(validation);
}

tl::expected<std::vector<std::size_t>, std::string> parse_fields(const std::string& text) {
  std::vector<std::size_t> fields;
  if (text.empty()) {
    for (std::size_t i = 0; i < kJudgmentFields.size(); ++i) fields.push_back(i);
    return fields;
  }
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string name = text.substr(at, comma - at);
    const int index = foosball::judgment_index(name);
    if (index < 0) {
      return tl::unexpected("\"" + name +
                            "\" is not a value of judgment: --list-judgment 5 shows their names");
    }
    const auto field = static_cast<std::size_t>(index);
    if (std::ranges::find(fields, field) != fields.end())
      return tl::unexpected(name + " is given twice: give it once");
    fields.push_back(field);
    at = comma + 1;
  }
  return fields;
}

tl::expected<Judgment, std::string> judgment_of_player(const std::string& player) {
  const auto at = player.find('@');
  const auto spec = foosball::parse_player(player.substr(0, at));
  if (!spec || spec->kind != foosball::PlayerSpec::Kind::level) {
    return tl::unexpected("\"" + player +
                          "\" has no judgment: give a level 1 to 5, maybe with a style");
  }
  const Judgment usual = judgment_of(spec->level, spec->style);
  if (at == std::string::npos) return usual;
  const auto changed = with_changes(usual, player.substr(at + 1));
  if (!changed) return tl::unexpected(changed.error().message);
  return *changed;
}

std::string with_judgment(const std::string& player, const Judgment& judgment) {
  const std::string level = player.substr(0, player.find('@'));
  const std::string changes = changes_of(*judgment_of_player(level), judgment);
  return changes.empty() ? level : level + "@" + changes;
}

std::vector<SeriesDesc> screen_series(const TrainPlan& plan) {
  const Judgment start = *judgment_of_player(plan.player);
  std::vector<SeriesDesc> all;
  for (std::size_t point = 0; point < design_points(plan); ++point) {
    Judgment judgment = start;
    for (std::size_t i = 0; i < plan.fields.size(); ++i) {
      judgment.*kJudgmentFields[plan.fields[i]].value =
          low_and_high(plan, plan.fields[i], start)[is_high(plan, point, i) ? 1 : 0];
    }
    for (const std::string& opponent : plan.opponents) {
      SeriesDesc desc = plan.base;
      desc.players = {with_judgment(plan.player, judgment), opponent};
      desc.max_games = plan.matches;
      for (SeriesDesc& one : in_both_layouts(desc)) all.push_back(std::move(one));
    }
  }
  return all;
}

std::vector<Figure> screen_figures(const TrainPlan& plan, std::span<const Series> series) {
  const std::string section = "screening of " + plan.player;
  const Judgment start = *judgment_of_player(plan.player);
  const std::size_t kinds = kLayouts.size() * plan.opponents.size();
  std::vector<Goals> all(kinds);
  for (std::size_t k = 0; k < series.size(); ++k) all[k % kinds].add(series[k]);
  std::vector<Figure> figures{{section, "all points", 100.0 * mean_share(all).value, "% of goals",
                               "", Figure::Judgment::none, 100.0 * mean_share(all).error}};
  for (std::size_t i = 0; i < plan.fields.size(); ++i) {
    std::array<std::vector<Goals>, 2> sides{std::vector<Goals>(kinds), std::vector<Goals>(kinds)};
    for (std::size_t k = 0; k < series.size(); ++k) {
      sides[is_high(plan, k / kinds, i) ? 1 : 0][k % kinds].add(series[k]);
    }
    const MeanShare low = mean_share(sides[0]), high = mean_share(sides[1]);
    const auto [from, to] = low_and_high(plan, plan.fields[i], start);
    figures.push_back(
        {section,
         std::string(kJudgmentFields[plan.fields[i]].name) + " " + shown(from) + " to " + shown(to),
         100.0 * (high.value - low.value), "% of goals", "", Figure::Judgment::none,
         100.0 * std::hypot(high.error, low.error)});
  }
  return figures;
}

namespace {

Point start_of(const TrainPlan& plan, const Judgment& start) {
  Point point;
  for (const std::size_t index : plan.fields) {
    const JudgmentField& field = kJudgmentFields[index];
    point.push_back(share_of(field, start.*field.value));
  }
  return point;
}

std::size_t population_of(const TrainPlan& plan) {
  return plan.population == 0 ? usual_population(plan.fields.size()) : plan.population;
}

}  // namespace

Training::Training(TrainPlan plan)
    : plan_(std::move(plan)),
      start_(*judgment_of_player(plan_.player)),
      search_(start_of(plan_, start_), plan_.step, population_of(plan_), plan_.base.seed) {}

Judgment Training::at(const Point& point) const {
  Judgment judgment = start_;
  for (std::size_t i = 0; i < plan_.fields.size(); ++i) {
    const JudgmentField& field = kJudgmentFields[plan_.fields[i]];
    judgment.*field.value = value_at(field, point[i]);
  }
  return judgment;
}

Judgment Training::answer() const {
  return search_.generation() == 0 ? start_ : at(search_.answer());
}

std::vector<SeriesDesc> Training::against(const std::string& player, const std::string& opponent,
                                          std::uint64_t seed, std::uint64_t matches) const {
  SeriesDesc desc = plan_.base;
  desc.players = {player, opponent};
  desc.seed = seed;
  desc.max_games = matches;
  return in_both_layouts(desc);
}

std::vector<SeriesDesc> Training::round() const {
  std::vector<SeriesDesc> all;
  const auto add = [&](std::vector<SeriesDesc> more) {
    std::move(more.begin(), more.end(), std::back_inserter(all));
  };
  const std::uint64_t seed = plan_.base.seed + kSeedsApart * search_.generation();
  if (search_.generation() < plan_.generations) {
    for (const Point& sample : search_.samples()) {
      const std::string player = with_judgment(plan_.player, at(sample));
      for (const std::string& opponent : plan_.opponents) {
        add(against(player, opponent, seed, plan_.matches));
      }
    }
  } else if (!over_ && plan_.validation > 0) {
    add(against(with_judgment(plan_.player, answer()), plan_.player, seed, plan_.validation));
  }
  return all;
}

void Training::take(std::span<const Series> series) {
  if (search_.generation() < plan_.generations) {
    const std::size_t each = kLayouts.size() * plan_.opponents.size();
    std::vector<double> values;
    for (std::size_t first = 0; first < series.size(); first += each) {
      std::vector<Goals> kinds(each);
      for (std::size_t k = 0; k < each; ++k) kinds[k].add(series[first + k]);
      values.push_back(mean_share(kinds).value);
    }
    double sum = 0.0;
    for (const double value : values) sum += value;
    shares_.push_back(sum / static_cast<double>(values.size()));
    search_.tell(values);
    return;
  }
  for (const Series& s : series) {
    const bool paper = s.desc().layout == foosball::Layout::paper;
    const std::string section = "trained against " + plan_.player +
                                (paper ? ", paper layout" : ", tournament layout") + ", new seeds";
    Goals goals;
    goals.add(s);
    validation_.push_back({section, "points", 100.0 * mean_score(s.pairs()), "% points", "",
                           Figure::Judgment::none, 100.0 * score_error(s.pairs())});
    validation_.push_back({section, "goals", 100.0 * goals.share(), "% of goals", "",
                           Figure::Judgment::none, 100.0 * goals.error()});
  }
  over_ = true;
}

std::uint64_t Training::games_at_most() const {
  const std::uint64_t each = plan_.matches * plan_.opponents.size() * kLayouts.size();
  return plan_.generations * search_.samples().size() * each + plan_.validation * kLayouts.size();
}

std::string Training::state() const {
  char text[120];
  std::snprintf(text, sizeof text,
                "generation %zu of %llu: %.1f %% of the goals in the mean, step %.3f",
                search_.generation(), static_cast<unsigned long long>(plan_.generations),
                shares_.empty() ? 50.0 : 100.0 * shares_.back(), search_.step());
  return text;
}

std::vector<Figure> Training::figures() const {
  std::vector<Figure> figures;
  for (std::size_t g = 0; g < shares_.size(); ++g) {
    figures.push_back({"samples of a generation, their mean", "generation " + std::to_string(g + 1),
                       100.0 * shares_[g], "% of goals", "", Figure::Judgment::none});
  }
  const Judgment trained = answer();
  for (const std::size_t index : plan_.fields) {
    const JudgmentField& field = kJudgmentFields[index];
    figures.push_back({"trained values of " + plan_.player, field.name, trained.*field.value,
                       field.unit, "before: " + shown(start_.*field.value),
                       Figure::Judgment::none});
  }
  figures.insert(figures.end(), validation_.begin(), validation_.end());
  return figures;
}

}  // namespace match
