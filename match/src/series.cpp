#include "match/series.h"

#include <algorithm>
#include <cstdio>
#include <initializer_list>

namespace match {
namespace {

int other_than(const SeriesDesc& desc, std::uint64_t seed) {
  const std::size_t others = desc.character_list.size() - 1;
  if (others == 0) return desc.characters[0];
  const int drawn = drawn_characters(seed, others)[0];
  return drawn < desc.characters[0] ? drawn : drawn + 1;
}

}  // namespace

std::string SeriesDesc::text() const {
  std::string text = players[0] + " - " + players[1];
  text += layout == foosball::Layout::paper ? ", paper" : ", tournament";
  text += ", seed " + std::to_string(seed) + ", " + std::to_string(max_ticks) + " ticks, " +
          std::to_string(max_games) + " games, characters ";
  text += draw_characters ? std::string("drawn")
                          : std::to_string(characters[0]) + "/" + std::to_string(characters[1]);
  text += " of " + std::to_string(foosball::digest(character_list));
  const auto add = [&](const char* name, std::initializer_list<double> values) {
    text += std::string(", ") + name;
    for (const double value : values) {
      text += ' ';
      text += std::to_string(value);
    }
  };
  // The values that differ from the defaults, with all digits: another tuning makes another series.
  visit_fields(tuning, [&](const foosball::TuningField& field, double value) {
    if (value == foosball::Tuning{}.*field.value) return;
    char digits[40];
    std::snprintf(digits, sizeof digits, " %.17g", value);
    text += std::string(", ") + field.name + digits;
  });
  if (test) add("test", {test->score0, test->score1, test->alpha, test->beta});
  if (band) add("band", {band->limit, band->alpha});
  return text;
}

std::uint64_t SeriesDesc::digest() const {
  std::uint64_t digest = 0;
  for (const char c : text()) digest = mix_seed(digest ^ static_cast<unsigned char>(c));
  return digest;
}

GameDesc Series::game(std::uint64_t index) const {
  const std::size_t first = index % 2;  // the team of the first player
  GameDesc game;
  game.players[first] = desc_.players[0];
  game.players[1 - first] = desc_.players[1];
  game.layout = desc_.layout;
  game.seed = desc_.seed + index / 2;
  game.variant = static_cast<int>(first);
  game.max_ticks = desc_.max_ticks;
  game.tuning = desc_.tuning;
  game.character_list = desc_.character_list;
  if (desc_.draw_characters) {
    game.characters = drawn_characters(game.seed, desc_.character_list.size());
  } else {
    game.characters[first] = desc_.characters[0];
    game.characters[1 - first] =
        desc_.characters[1] == kAnyOther ? other_than(desc_, game.seed) : desc_.characters[1];
  }
  return game;
}

void Series::take(const GameResult& result) {
  const std::size_t first = taken_ % 2;  // the team of the first player
  const int half_points = result.half_points(static_cast<int>(first));
  goals_[0] += static_cast<std::uint64_t>(result.score[first]);
  goals_[1] += static_cast<std::uint64_t>(result.score[1 - first]);
  ++games_[static_cast<std::size_t>(2 - half_points)];
  statistics_.merge(result.statistics);
  digest_ = mix_seed(digest_ ^ result.state_hash);
  if (taken_ % 2 == 0) {
    first_of_pair_ = half_points;
  } else {
    const auto pair = static_cast<std::size_t>(first_of_pair_ + half_points);
    ++pairs_[pair];
    band_.take(pair);
  }
  ++taken_;
}

bool Series::decided() const {
  return taken_ >= desc_.max_games || (taken_ % 2 == 0 && verdict() != Verdict::open);
}

Verdict Series::verdict() const {
  if (desc_.test) return desc_.test->verdict(pairs_);
  return desc_.band ? band_.verdict() : Verdict::open;
}

}  // namespace match
