// Measures how characters differ, and how one number of a character affects its play: a tool for
// tuning characters/data. docs/characters.md has the results.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "match/report.h"
#include "match/series.h"

namespace match {

// One number of one character, varied from low to high in equal steps.
struct VariedNumber {
  std::size_t character = 0;  // index in the list
  std::size_t field = 0;      // index in foosball::kBodyFields
  double low = 0.0, high = 0.0;
  int steps = 5;  // at least 2
  double value(int step) const;
};

// Reads "NAME:KEY=LOW:HIGH" or "NAME:KEY=LOW:HIGH:STEPS" (2 to 50, default 5), such as "tall and
// thin:mass=0.05:0.09". The error is a sentence: unreadable text, a value out of range, or an
// unknown character.
tl::expected<VariedNumber, std::string> parse_varied(const std::string& text,
                                                     const foosball::Characters& characters);

// One series per value: the character against all others. The opponents are drawn from the pairs'
// seeds, which are the same for every value. base: players, layout, seed, games per series.
std::vector<SeriesDesc> varied_series(const SeriesDesc& base, const VariedNumber& varied);
// Points at each value [%], and the value that gives half of the points on a fitted line.
std::vector<Figure> varied_figures(const VariedNumber& varied, const std::vector<Series>& series);

// One series per character, in the list's order: matches of the character against itself. The
// results are then those of its own attack and defence.
std::vector<SeriesDesc> trait_series(const SeriesDesc& base);
std::vector<Figure> trait_figures(const std::vector<Series>& series);
// The same as a markdown table with one row per character.
std::string trait_table(const std::vector<Series>& series);

}  // namespace match
