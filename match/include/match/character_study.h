// What sets characters apart, and what one number of a character does to how well it plays: for
// whoever tunes characters/data. docs/characters.md has the results.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "match/report.h"
#include "match/series.h"

namespace match {

// One number of one character, at equal steps from low to high.
struct VariedNumber {
  std::size_t character = 0;  // of the list
  std::size_t field = 0;      // of foosball::kBodyFields
  double low = 0.0, high = 0.0;
  int steps = 5;  // at least 2
  double value(int step) const;
};

// "NAME:KEY=LOW:HIGH" or "NAME:KEY=LOW:HIGH:STEPS" (2 to 50, else 5), as in "tall and
// thin:mass=0.05:0.09". The error is a sentence: what cannot be read, is out of range, or is of no
// character.
tl::expected<VariedNumber, std::string> parse_varied(const std::string& text,
                                                     const foosball::Characters& characters);

// For each value a series of the character against all others, drawn by the pairs' seeds, which are
// the same at every value. base: players, layout, seed, games of each.
std::vector<SeriesDesc> varied_series(const SeriesDesc& base, const VariedNumber& varied);
// Points at each value [%], and the value for half of the points on the line through them.
std::vector<Figure> varied_figures(const VariedNumber& varied, const std::vector<Series>& series);

// For each character a series of matches against itself, in the list's order: what is measured is
// the character's own, of attack and of defense.
std::vector<SeriesDesc> trait_series(const SeriesDesc& base);
std::vector<Figure> trait_figures(const std::vector<Series>& series);
// The same as a table with a row for each character (markdown).
std::string trait_table(const std::vector<Series>& series);

}  // namespace match
