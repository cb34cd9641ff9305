#include "match/study.h"

#include <cmath>
#include <cstdio>

namespace match {
namespace {

// Number of levels of a value that is varied alone.
constexpr int kLevels = 5;

// Van der Corput's sequence in this base: the digits of the index, reversed behind the point.
double radical_inverse(std::uint64_t index, std::uint64_t base) {
  double value = 0.0, digit = 1.0 / static_cast<double>(base);
  for (; index > 0; index /= base, digit /= static_cast<double>(base)) {
    value += digit * static_cast<double>(index % base);
  }
  return value;
}

double& value_of(foosball::Tuning& tuning, const StudiedValue& studied) {
  const auto index = static_cast<std::size_t>(foosball::tuning_index(studied.name));
  return tuning.*foosball::kTuningFields[index].value;
}

std::string setting(const StudiedValue& studied, double value) {
  char text[64];
  std::snprintf(text, sizeof text, " %s=%.6g", studied.name, value);
  return text;
}

double between(const StudiedValue& studied, double share) {
  return std::lerp(studied.low, studied.high, share);
}

}  // namespace

// Grouped by the part of play that they affect: flight, bounce, exaggeration, strength of the hand,
// sag.
const std::vector<StudiedValue>& studied_values() {
  static const std::vector<StudiedValue> kValues{
      {"gravity", 8.0, 24.0},         {"field_restitution", 0.3, 0.85},
      {"wall_restitution", 0.5, 0.9}, {"rolling_resistance", 0.00005, 0.0006},
      {"hop_gain", 1.0, 3.5},         {"bounce_gain", 0.0, 0.8},
      {"bounce_from", 0.5, 5.0},      {"bounce_most", 0.8, 2.6},
      {"hop_ceiling", 0.04, 0.16},    {"sag_from", 0.030, 0.070},
      {"sag_acceleration", 0.1, 0.9}, {"turn_rate", 60.0, 160.0},
  };
  return kValues;
}

std::vector<StudyPoint> study_points(std::uint64_t samples, const foosball::Tuning& about) {
  std::vector<StudyPoint> points{{"defaults", about}};
  for (const StudiedValue& studied : studied_values()) {
    points[0].name += setting(studied, value_of(points[0].tuning, studied));
  }
  for (const StudiedValue& studied : studied_values()) {
    for (int level = 0; level < kLevels; ++level) {
      const double value = between(studied, static_cast<double>(level) / (kLevels - 1));
      StudyPoint point{"one" + setting(studied, value), about};
      value_of(point.tuning, studied) = value;
      points.push_back(point);
    }
  }
  constexpr std::uint64_t kBases[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  // The first points of the larger bases lie on a line.
  constexpr std::uint64_t kSkipped = 409;
  for (std::uint64_t sample = 0; sample < samples; ++sample) {
    StudyPoint point{"fill", about};
    for (std::size_t i = 0; i < studied_values().size(); ++i) {
      const StudiedValue& studied = studied_values()[i];
      const double value = between(studied, radical_inverse(kSkipped + sample, kBases[i]));
      value_of(point.tuning, studied) = value;
      point.name += setting(studied, value);
    }
    points.push_back(point);
  }
  return points;
}

std::vector<SeriesDesc> study_series(const StudyPlan& plan) {
  std::vector<SeriesDesc> all;
  for (const StudyPoint& point : study_points(plan.samples, plan.tuning)) {
    SeriesDesc desc;
    desc.players = {plan.player, plan.player};
    desc.seed = plan.seed;
    desc.max_ticks = plan.max_ticks;
    desc.max_games = plan.matches;
    desc.tuning = point.tuning;
    desc.character_list = plan.character_list;
    for (const auto layout : {foosball::Layout::tournament, foosball::Layout::paper}) {
      desc.layout = layout;
      all.push_back(desc);
    }
  }
  return all;
}

std::vector<Figure> study_figures(const StudyPlan& plan, const std::vector<Series>& series) {
  std::vector<Figure> all;
  const std::vector<StudyPoint> points = study_points(plan.samples, plan.tuning);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const bool paper = series[i].desc().layout == foosball::Layout::paper;
    const std::string section =
        (paper ? std::string("paper; ") : std::string("tournament; ")) + points[i / 2].name;
    for (Figure& figure : figures_of(section, series[i].statistics())) all.push_back(figure);
  }
  return all;
}

}  // namespace match
