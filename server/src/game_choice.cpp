#include "server/game_choice.h"

#include <algorithm>

#include "wire/limits.h"

namespace server {

static_assert(wire::kMaxGoals == foosball::kMaxGoals);
static_assert(wire::kMaxSets == foosball::kMaxSets);
static_assert(wire::kMaxMatchMs == foosball::kMaxMatchMs);
static_assert(wire::kLastDate == foosball::kLastDate);
static_assert(wire::kStyleCount == foosball::kPlayStyles);

foosball::PlayerSpec player_of(const Opponent& opponent) {
  const auto style = opponent.style > 0 ? static_cast<foosball::PlayStyle>(opponent.style - 1)
                                        : foosball::style_of_level(opponent.level);
  return {.level = opponent.level, .style = style};
}

Opponent opponent_of(const foosball::PlayerSpec& player) {
  const bool suits = player.style == foosball::style_of_level(player.level);
  return {player.level, suits ? 0 : 1 + static_cast<int>(player.style)};
}

foosball::PlayerSpec player_in(foosball::Mode mode, int rung, std::uint64_t challenge,
                               const foosball::PlayerSpec& chosen) {
  static_assert(foosball::kLadderRungs == foosball::kLevels);
  if (mode == foosball::Mode::challenge) return foosball::challenge_opponent(challenge);
  if (mode == foosball::Mode::ladder) return player_of({.level = foosball::level_of_rung(rung)});
  return chosen;
}

GameSite site_of(const foosball::MatchDesc& match, bool computer, bool cabinet) {
  const foosball::Characters& built_in = foosball::built_in_characters();
  GameSite site;
  site.computer = computer;
  site.cabinet = cabinet;
  site.tournament_table = match.layout == foosball::Layout::tournament;
  site.built_in_characters = match.characters.size() >= built_in.size() &&
                             std::equal(built_in.begin(), built_in.end(), match.characters.begin());
  site.default_tuning = match.tuning == foosball::Tuning{};
  return site;
}

wire::Sentence why_not(const wire::Game& asked, const GameSite& site) {
  using foosball::Mode;
  using wire::make_sentence;
  using wire::SentenceId;
  const foosball::GameSetup setup = setup_of(asked, 0);
  const bool in_range = foosball::in_range(setup) && asked.level <= foosball::kLevels &&
                        asked.style <= foosball::kPlayStyles && asked.date == 0 &&
                        (asked.style == 0 || asked.level != 0);
  if (!in_range) return make_sentence<SentenceId::no_such_game>();
  const bool opponent = asked.level != 0 || asked.style != 0;
  const bool contradicts = setup != only_chosen(setup);
  if (setup.mode == Mode::challenge && (contradicts || opponent))
    return make_sentence<SentenceId::challenge_is_set>();
  if (contradicts) return make_sentence<SentenceId::training_has_no_end>();
  if (opponent && !chooses_opponent(setup.mode))
    return make_sentence<SentenceId::ladder_has_its_levels>();
  if (!chooses_opponent(setup.mode) && !site.computer)
    return make_sentence<SentenceId::no_computer_here>();
  if (setup.change_sides && !site.cabinet) return make_sentence<SentenceId::sides_at_a_cabinet>();
  if (setup.change_sides && rules_of(setup).sets_to_win == 1)
    return make_sentence<SentenceId::sides_between_sets>();
  if (setup.mode != Mode::challenge) return {};
  if (!site.tournament_table) return make_sentence<SentenceId::challenge_table>();
  if (!site.built_in_characters) return make_sentence<SentenceId::challenge_characters>();
  if (!site.default_tuning) return make_sentence<SentenceId::challenge_tuning>();
  return {};
}

foosball::GameSetup setup_of(const wire::Game& asked, std::uint32_t date) {
  foosball::GameSetup setup;
  setup.mode = static_cast<foosball::Mode>(asked.mode);
  setup.rules = static_cast<foosball::RuleSet>(asked.rule_set);
  setup.goals = asked.goals;
  setup.sets = asked.sets;
  setup.match_ms = asked.match_ms;
  setup.change_sides = asked.change_sides;
  setup.date = setup.mode == foosball::Mode::challenge ? date : 0;
  return setup;
}

wire::Game to_game(const foosball::GameSetup& setup) {
  wire::Game game;
  game.mode = static_cast<std::uint8_t>(setup.mode);
  game.rule_set = static_cast<std::uint8_t>(setup.rules);
  game.goals = static_cast<std::uint8_t>(setup.goals);
  game.sets = static_cast<std::uint8_t>(setup.sets);
  game.match_ms = setup.match_ms;
  game.change_sides = setup.change_sides;
  return game;
}

wire::Game to_game(const foosball::GameSetup& setup, const Opponent& opponent, bool waits) {
  wire::Game game = to_game(setup);
  game.date = setup.date;
  game.waits = waits;
  if (setup.mode == foosball::Mode::ladder) return game;
  const foosball::PlayerSpec drawn = foosball::challenge_opponent(setup.date);
  const Opponent who = setup.mode == foosball::Mode::challenge
                           ? Opponent{drawn.level, 1 + static_cast<int>(drawn.style)}
                           : opponent;
  game.level = static_cast<std::uint8_t>(who.level);
  game.style = static_cast<std::uint8_t>(who.style);
  return game;
}

std::uint32_t day_of(const std::string& date) {
  std::uint32_t day = 0;
  for (const char c : date.substr(0, 10))
    if (c >= '0' && c <= '9') day = 10 * day + static_cast<std::uint32_t>(c - '0');
  return foosball::is_date(day) ? day : 0;
}

}  // namespace server
