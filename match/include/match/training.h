// Optimizes the values of a computer player's judgment (foosball/judgment.h) for its score against
// other players: a screening of all values, and a search over the important ones by an evolution
// strategy (match/evolution.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "foosball/judgment.h"
#include "match/evolution.h"
#include "match/report.h"
#include "match/series.h"

namespace match {

struct TrainPlan {
  std::string player = "5";  // start of the search: a level, optionally with a style and values
  std::vector<std::string> opponents{"5", "classic:0.9"};
  std::vector<std::size_t> fields;  // indices in foosball::kJudgmentFields
  // Settings of all games, except the layout; its seed is the first generation's.
  SeriesDesc base{};
  std::uint64_t matches = 4;   // per sample, opponent and layout; even
  std::size_t population = 0;  // 0: usual_population()
  std::uint64_t generations = 20;
  double step = 0.10;              // of the first generation, as a fraction of each range
  std::uint64_t validation = 100;  // matches of the answer against the start, per layout; even
  std::string text() const;        // settings that the series do not contain
};

// The named fields, such as "shot_bar,patience"; all fields for an empty text.
tl::expected<std::vector<std::size_t>, std::string> parse_fields(const std::string& text);

// The judgment of a player as the start of a search. The error says why the player is not suitable.
tl::expected<foosball::Judgment, std::string> judgment_of_player(const std::string& player);
// The player's level and style with this judgment. Precondition: judgment_of_player() accepts
// player.
std::string with_judgment(const std::string& player, const foosball::Judgment& judgment);

// A two-level design. Each value is lower or higher than the player's by `step` of its range
// (clamped to it). All values vary at the same time, by the rows of a Hadamard matrix and the same
// rows with high and low exchanged. So every game contributes to every value's effect, and no main
// effect is confounded with another or with a two-factor interaction. Plackett and Burman 1946
// (plackett1946), Box and Hunter 1961 (box1961), docs/references.bib.
std::vector<SeriesDesc> screen_series(const TrainPlan& plan);
// The fraction of goals of all points, and for each value its increase from the low to the high
// level. Precondition: the series of screen_series(plan), in their order.
std::vector<Figure> screen_figures(const TrainPlan& plan, std::span<const Series> series);

// A search in rounds of series. All samples of a generation have the same serves and characters;
// the next generation has others. The last round plays the answer against the start, with seeds
// that no generation had.
class Training {
 public:
  explicit Training(TrainPlan plan);

  // The series of this round; empty when the search is over.
  std::vector<SeriesDesc> round() const;
  // The finished series of round(), in order.
  void take(std::span<const Series> series);
  std::uint64_t games_at_most() const;  // upper bound for all rounds

  std::size_t generations() const { return search_.generation(); }  // number completed
  std::string state() const;  // one line about the last completed generation
  foosball::Judgment start() const { return start_; }
  foosball::Judgment answer() const;  // current
  std::vector<Figure> figures() const;

 private:
  foosball::Judgment at(const Point& point) const;
  std::vector<SeriesDesc> against(const std::string& player, const std::string& opponent,
                                  std::uint64_t seed, std::uint64_t matches) const;

  TrainPlan plan_;
  foosball::Judgment start_;
  EvolutionStrategy search_;
  std::vector<double> shares_;  // fraction of goals [1], mean over each generation's samples
  std::vector<Figure> validation_;
  bool over_ = false;
};

}  // namespace match
