#include "match/series.h"

#include <algorithm>
#include <cstdio>

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
  text += " of " + std::to_string(digest(character_list));
  const auto add = [&](const char* name, const std::optional<SequentialTest>& t) {
    if (!t) return;
    text += std::string(", ") + name;
    for (const double value : {t->score0, t->score1, t->alpha, t->beta}) {
      text += ' ';
      text += std::to_string(value);
    }
  };
  // Of those that are not the defaults, all digits: another tuning is another series.
  visit_fields(tuning, [&](const foosball::TuningField& field, double value) {
    if (value == foosball::Tuning{}.*field.value) return;
    char digits[40];
    std::snprintf(digits, sizeof digits, " %.17g", value);
    text += std::string(", ") + field.name + digits;
  });
  add("test", test);
  add("band", band);
  return text;
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
  const int half_points = result.half_points(static_cast<int>(taken_ % 2));
  ++games_[static_cast<std::size_t>(2 - half_points)];
  statistics_.merge(result.statistics);
  digest_ = mix_seed(digest_ ^ result.state_hash);
  if (taken_ % 2 == 0) {
    first_of_pair_ = half_points;
  } else {
    ++pairs_[static_cast<std::size_t>(first_of_pair_ + half_points)];
  }
  ++taken_;
}

bool Series::decided() const {
  return taken_ >= desc_.max_games || (taken_ % 2 == 0 && verdict() != Verdict::open);
}

Verdict Series::verdict() const {
  if (desc_.test) return desc_.test->verdict(pairs_);
  if (!desc_.band) return Verdict::open;
  SequentialTest one_side = *desc_.band;
  one_side.alpha *= 0.5;
  PairCounts mirrored = pairs_;
  std::reverse(mirrored.begin(), mirrored.end());
  const Verdict first = one_side.verdict(pairs_), second = one_side.verdict(mirrored);
  if (first == Verdict::h1 || second == Verdict::h1) return Verdict::h1;
  return first == Verdict::h0 && second == Verdict::h0 ? Verdict::h0 : Verdict::open;
}

}  // namespace match
