// Games that are evaluated together, in order: a fixed number, or as many as a sequential test
// needs. Games can be played anywhere and in any order. A series processes the results in its own
// order and stops at the first point where it is decided. So its totals do not depend on the number
// of threads or machines. Results beyond that point do not count.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "foosball/statistics.h"
#include "match/game.h"
#include "match/sequential.h"

namespace match {

// Any character except the first player's.
inline constexpr int kAnyOther = -1;

// Two players in mirrored pairs. Games 2k and 2k + 1 have the same match seed, hence the same first
// serve and the same characters on each side, but exchanged sides. The players' own seeds differ,
// so that a player against itself does not play the same game twice.
struct SeriesDesc {
  std::array<std::string, 2> players;  // the first is on team 0 in even games
  foosball::Layout layout = foosball::Layout::tournament;
  std::uint64_t seed = 1;  // of the first pair
  std::uint64_t max_ticks = 600'000;
  std::uint64_t max_games = 100;  // even
  foosball::Tuning tuning{};      // of every game
  foosball::Characters character_list = foosball::built_in_characters();
  bool draw_characters = true;          // for each side of each pair, from its seed; false:
  std::array<int, 2> characters{1, 1};  // the players' characters, indices in that list; the second
                                        // may be kAnyOther: drawn for each pair from its seed
  std::optional<SequentialTest> test;   // of the first player's score; none: max_games decides
  std::optional<Band> band;             // alternatively: tests if that score lies within the band
  std::string text() const;             // complete, for a checkpoint
  std::uint64_t digest() const;         // of the text
};

class Series {
 public:
  explicit Series(SeriesDesc desc)
      : desc_(std::move(desc)),
        digest_of_desc_(desc_.digest()),
        band_(desc_.band.value_or(Band{})) {}

  const SeriesDesc& desc() const { return desc_; }
  std::uint64_t digest_of_desc() const { return digest_of_desc_; }
  GameDesc game(std::uint64_t index) const;
  // Preconditions: it is the result of game taken(), and not decided().
  void take(const GameResult& result);
  std::uint64_t taken() const { return taken_; }
  bool decided() const;
  Verdict verdict() const;  // current verdict of the test or the band

  // Of the first player, in half points of a pair: [0] both games lost .. [4] both won.
  const PairCounts& pairs() const { return pairs_; }
  std::array<std::uint64_t, 3> wins_draws_losses() const { return games_; }
  // Of the first player, and of the second.
  std::array<std::uint64_t, 2> goals() const { return goals_; }
  const foosball::Statistics& statistics() const { return statistics_; }
  // Of all results in order: equal digests mean equal results in every game.
  std::uint64_t digest() const { return digest_; }

 private:
  SeriesDesc desc_;
  std::uint64_t digest_of_desc_;
  BandTest band_;
  std::uint64_t taken_ = 0;
  int first_of_pair_ = 0;
  PairCounts pairs_{};
  std::array<std::uint64_t, 3> games_{};
  std::array<std::uint64_t, 2> goals_{};
  foosball::Statistics statistics_;
  std::uint64_t digest_ = 0;
};

}  // namespace match
