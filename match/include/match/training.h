// Which values of a computer player's judgment (foosball/judgment.h) score most against other
// players: a screening of all of them, and a search over those that matter by an evolution
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
  std::string player = "5";  // a level, maybe with a style and values: where the search begins
  std::vector<std::string> opponents{"5", "classic:0.9"};
  std::vector<std::size_t> fields;  // of foosball::kJudgmentFields
  SeriesDesc base{};                // layout aside, what all games have in common; its seed is the
                                    // first generation's
  std::uint64_t matches = 4;        // of each sample against each opponent in each layout; even
  std::size_t population = 0;       // 0: usual_population()
  std::uint64_t generations = 20;
  double step = 0.10;              // of the first generation, as a share of each range
  std::uint64_t validation = 100;  // matches of the answer against the start in each layout; even
  std::string text() const;        // what the series do not say
};

// All fields of an empty text, else those that it names: "shot_bar,patience".
tl::expected<std::vector<std::size_t>, std::string> parse_fields(const std::string& text);

// The judgment of a player that a search can begin with, or why it is none.
tl::expected<foosball::Judgment, std::string> judgment_of_player(const std::string& player);
// player's level and style with this judgment. Precondition: judgment_of_player() accepts player.
std::string with_judgment(const std::string& player, const foosball::Judgment& judgment);

// A design of two levels: each value lower or higher than the player's by `step` of its range (as
// far as that goes), all values at a time, by the rows of a Hadamard matrix and the same rows with
// high and low exchanged. Every game then tells of every value, no value's effect is mixed with
// that of another, nor with what two others do together. Plackett and Burman 1946 (plackett1946),
// Box and Hunter 1961 (box1961), docs/references.bib.
std::vector<SeriesDesc> screen_series(const TrainPlan& plan);
// The share of goals of all points, and of each value how much larger it is where that is high than
// where it is low. Precondition: the series of that plan, in their order.
std::vector<Figure> screen_figures(const TrainPlan& plan, std::span<const Series> series);

// A search: rounds of series. All samples of a generation play the same serves and characters; the
// next generation plays others. The last round sets the answer against the start on seeds that no
// generation had.
class Training {
 public:
  explicit Training(TrainPlan plan);

  // Those of this round; empty when it is over.
  std::vector<SeriesDesc> round() const;
  // The finished series of round(), in order.
  void take(std::span<const Series> series);
  std::uint64_t games_at_most() const;  // of all rounds

  std::size_t generations() const { return search_.generation(); }  // taken
  std::string state() const;  // one line on the generation last taken
  foosball::Judgment start() const { return start_; }
  foosball::Judgment answer() const;  // so far
  std::vector<Figure> figures() const;

 private:
  foosball::Judgment at(const Point& point) const;
  std::vector<SeriesDesc> against(const std::string& player, const std::string& opponent,
                                  std::uint64_t seed, std::uint64_t matches) const;

  TrainPlan plan_;
  foosball::Judgment start_;
  EvolutionStrategy search_;
  std::vector<double> shares_;  // of goals [1], the mean of each generation's samples
  std::vector<Figure> validation_;
  bool over_ = false;
};

}  // namespace match
