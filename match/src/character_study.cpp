#include "match/character_study.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace match {
namespace {

using foosball::Statistics;

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", value);
  return text;
}

bool read(const std::string& text, double& value) {
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc{} && result.ptr == end;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

// A copy of the list with this value.
foosball::Characters with_value(foosball::Characters list, const VariedNumber& varied,
                                double value) {
  list[varied.character].body.*foosball::kBodyFields[varied.field].value = value;
  return list;
}

// The value at which a least-squares line (equal weights) crosses 50 %; NaN if the line is flat.
double balanced_value(const std::vector<double>& values, const std::vector<double>& scores) {
  const auto n = static_cast<double>(values.size());
  const double mean_value = std::accumulate(values.begin(), values.end(), 0.0) / n;
  const double mean_score = std::accumulate(scores.begin(), scores.end(), 0.0) / n;
  double covariance = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    covariance += (values[i] - mean_value) * (scores[i] - mean_score);
    variance += (values[i] - mean_value) * (values[i] - mean_value);
  }
  if (covariance == 0.0) return std::nan("");
  return mean_value + (50.0 - mean_score) * variance / covariance;
}

template <class Counts>
double total_of(const Counts& counts) {
  return static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
}

struct Trait {
  const char* name;
  const char* unit;
  int digits;
  double (*of)(const Statistics&);
};
double minutes(const Statistics& s) {
  return static_cast<double>(s.play_ticks) * foosball::kTick / 60.0;
}
constexpr Trait kTraits[] = {
    {"goals", "a minute", 2, [](const Statistics& s) { return total_of(s.goals) / minutes(s); }},
    {"shots", "a minute", 1, [](const Statistics& s) { return total_of(s.shots) / minutes(s); }},
    {"shot speed, median", "m/s", 2,
     [](const Statistics& s) { return s.shot_speed.quantile(0.5); }},
    {"90 %", "m/s", 2, [](const Statistics& s) { return s.shot_speed.quantile(0.9); }},
    {"on target", "%", 1,
     [](const Statistics& s) { return 100.0 * total_of(s.shots_on_target) / total_of(s.shots); }},
    {"of these saved", "%", 1,
     [](const Statistics& s) { return 100.0 * total_of(s.saves) / total_of(s.shots_on_target); }},
    {"hop, median", "mm", 0, [](const Statistics& s) { return 1e3 * s.hop_height.quantile(0.5); }},
    {"hop, 90 %", "mm", 0, [](const Statistics& s) { return 1e3 * s.hop_height.quantile(0.9); }},
    {"touches", "a minute", 0,
     [](const Statistics& s) { return total_of(s.touches) / minutes(s); }},
};

const foosball::Character& character_of(const Series& series) {
  const SeriesDesc& desc = series.desc();
  return desc.character_list[static_cast<std::size_t>(desc.characters[0])];
}

}  // namespace

double VariedNumber::value(int step) const {
  return std::lerp(low, high, static_cast<double>(step) / static_cast<double>(steps - 1));
}

tl::expected<VariedNumber, std::string> parse_varied(const std::string& text,
                                                     const foosball::Characters& characters) {
  const auto refuse = [&](const std::string& why) {
    return tl::unexpected("\"" + text + "\": " + why + "; give NAME:KEY=LOW:HIGH:STEPS, as in \"" +
                          characters.front().name + ":mass=0.05:0.09:5\"");
  };
  VariedNumber varied;
  const auto parts = split(text, '=');
  const auto colon = parts[0].rfind(':');
  if (parts.size() != 2 || colon == std::string::npos) return refuse("is no number of a character");
  const std::string name = parts[0].substr(0, colon), key = parts[0].substr(colon + 1);
  while (varied.character < characters.size() && characters[varied.character].name != name) {
    ++varied.character;
  }
  if (varied.character == characters.size()) return refuse("there is no \"" + name + "\"");
  while (varied.field < foosball::kBodyFields.size() &&
         foosball::kBodyFields[varied.field].name != key) {
    ++varied.field;
  }
  if (varied.field == foosball::kBodyFields.size()) return refuse("there is no \"" + key + "\"");
  const auto range = split(parts[1], ':');
  double steps = varied.steps;
  if (range.size() < 2 || range.size() > 3 || !read(range[0], varied.low) ||
      !read(range[1], varied.high) || (range.size() == 3 && !read(range[2], steps))) {
    return refuse("LOW, HIGH and STEPS are numbers");
  }
  if (!(steps >= 2.0 && steps <= 50.0)) return refuse("STEPS is from 2 to 50");
  varied.steps = static_cast<int>(steps);
  for (const double value : {varied.low, varied.high}) {
    if (!in_range(with_value(characters, varied, value))) {
      return refuse(short_number(value) + " is out of the range of " + key +
                    " (docs/characters.md)");
    }
  }
  if (characters.size() < 2) return refuse("it has nobody to play against");
  return varied;
}

std::vector<SeriesDesc> varied_series(const SeriesDesc& base, const VariedNumber& varied) {
  std::vector<SeriesDesc> all;
  for (int step = 0; step < varied.steps; ++step) {
    SeriesDesc desc = base;
    desc.character_list = with_value(base.character_list, varied, varied.value(step));
    desc.draw_characters = false;
    desc.characters = {static_cast<int>(varied.character), kAnyOther};
    all.push_back(desc);
  }
  return all;
}

std::vector<Figure> varied_figures(const VariedNumber& varied, const std::vector<Series>& series) {
  std::vector<Figure> all;
  std::vector<double> values, scores;
  const auto& field = foosball::kBodyFields[varied.field];
  const std::string section =
      character_of(series[0]).name + " against all others, by " + field.name +
      (*field.unit ? std::string(" [") + field.unit + "]" : "") + "; +- one standard error";
  for (std::size_t step = 0; step < series.size(); ++step) {
    values.push_back(varied.value(static_cast<int>(step)));
    scores.push_back(100.0 * mean_score(series[step].pairs()));
    all.push_back({section, std::string(field.name) + " = " + short_number(values.back()),
                   scores.back(), "% points", "", Figure::Judgment::none,
                   100.0 * score_error(series[step].pairs())});
  }
  const double balanced = balanced_value(values, scores);
  const bool outside = balanced < values.front() || balanced > values.back();
  all.push_back({section,
                 std::string("for half of the points, by a line") + (outside ? ", outside" : ""),
                 balanced, field.unit, "", Figure::Judgment::none});
  return all;
}

std::vector<SeriesDesc> trait_series(const SeriesDesc& base) {
  std::vector<SeriesDesc> all;
  for (std::size_t c = 0; c < base.character_list.size(); ++c) {
    SeriesDesc desc = base;
    desc.draw_characters = false;
    desc.characters = {static_cast<int>(c), static_cast<int>(c)};
    all.push_back(desc);
  }
  return all;
}

std::vector<Figure> trait_figures(const std::vector<Series>& series) {
  std::vector<Figure> all;
  for (const Series& s : series) {
    const foosball::Character& character = character_of(s);
    for (const Trait& trait : kTraits) {
      all.push_back({character.name, trait.name, trait.of(s.statistics()), trait.unit, "",
                     Figure::Judgment::none});
    }
  }
  return all;
}

std::string trait_table(const std::vector<Series>& series) {
  std::string text = "| character |", rule = "|---|";
  for (const Trait& trait : kTraits) {
    text += std::string(" ") + trait.name + " (" + trait.unit + ") |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const Series& s : series) {
    const foosball::Character& character = character_of(s);
    text += "| " + character.name + " |";
    for (const Trait& trait : kTraits) {
      char cell[32];
      std::snprintf(cell, sizeof cell, " %.*f |", trait.digits, trait.of(s.statistics()));
      text += cell;
    }
    text += "\n";
  }
  return text;
}

}  // namespace match
