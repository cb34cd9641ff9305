#include "client/game_menu.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "wire/enums.h"
#include "wire/limits.h"

#define N_(english) english  // for xgettext: render/translate.h

namespace client {
namespace {

enum Row : int {
  row_mode,
  row_level,
  row_style,
  row_rules,
  row_goals,
  row_sets,
  row_minutes,
  row_sides,
  row_begin,
  row_count
};

constexpr int kLevels = 5;  // of computer players
constexpr std::array<const char*, wire::kModeCount> kModeNames{
    N_("match"), N_("training"), N_("challenge of the day"), N_("ladder")};
constexpr std::array<const char*, wire::kModeCount> kModeNotes{
    N_("One match between two sides. A change takes effect before a match begins; in play it waits "
       "for the next."),
    N_("The ball is served to you again and again, without an end. A change takes effect before a "
       "match begins; in play it waits for the next."),
    N_("Two minutes against the opponent of the day: the same for everybody, at every try. In play "
       "it waits for the next match."),
    N_("Match after match, each against a stronger computer, as long as you win. A change takes "
       "effect before a match begins; in play it waits for the next.")};
constexpr std::array<const char*, wire::kRuleSetCount> kRulesNames{N_("arcade"),
                                                                   N_("tournament (ITSF)")};
constexpr std::array<const char*, wire::kStyleCount + 1> kStyleNames{
    N_("as suits the level"), N_("wall"), N_("shooter"), N_("passer"), N_("gambler")};
constexpr std::array<std::uint32_t, 11> kMinutes{0, 1, 2, 3, 4, 5, 10, 15, 20, 30, 60};
constexpr std::uint32_t kMinuteMs = 60'000;

foosball::GameSetup setup_of(const wire::Game& game) {
  foosball::GameSetup setup;
  setup.mode = static_cast<foosball::Mode>(game.mode);
  setup.rules = static_cast<foosball::RuleSet>(game.rule_set);
  setup.goals = game.goals;
  setup.sets = game.sets;
  setup.match_ms = game.match_ms;
  setup.change_sides = game.change_sides;
  return setup;
}

foosball::Mode mode_of(const wire::Game& game) {
  return static_cast<foosball::Mode>(game.mode);
}

// The game as requested.
wire::Game asked_for(wire::Game game) {
  const foosball::GameSetup setup = only_chosen(setup_of(game));
  game.rule_set = static_cast<std::uint8_t>(setup.rules);
  game.goals = static_cast<std::uint8_t>(setup.goals);
  game.sets = static_cast<std::uint8_t>(setup.sets);
  game.match_ms = setup.match_ms;
  game.change_sides = setup.change_sides;
  if (!chooses_opponent(setup.mode)) game.level = game.style = 0;
  game.date = 0;
  game.waits = false;
  return game;
}

// The server reports the actual numbers where the request left them to the rules.
bool same_game(const wire::Game& asked, const wire::Game& reported) {
  const bool opponent =
      asked.level == 0 || (asked.level == reported.level && asked.style == reported.style);
  return asked.mode == reported.mode && opponent &&
         rules_of(setup_of(asked)) == rules_of(setup_of(asked_for(reported)));
}

int turned(int value, int way, int count) {
  return ((value + way) % count + count) % count;
}

std::string minutes_text(std::uint32_t ms) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", static_cast<double>(ms) / kMinuteMs);
  return text;
}

}  // namespace

void GameMenu::update(std::uint64_t session, const std::optional<wire::Game>& reported,
                      bool may_change, const std::string& refused) {
  if (session != session_) kept_ = {};
  if (session != session_ || !may_change || !reported) asking_ = false;
  session_ = session;
  may_change_ = may_change && reported.has_value();
  refused_ = refused;
  reported_ = reported;
  if (reported && asking_ && same_game(wanted(), *reported)) asking_ = false;
  if (reported && !asking_) take(*reported);
}

// Values that the mode does not define keep the choice made for the other modes.
void GameMenu::take(const wire::Game& reported) {
  const foosball::Mode mode = mode_of(reported);
  kept_.mode = reported.mode;
  if (chooses_opponent(mode)) {
    kept_.level = reported.level;
    kept_.style = reported.style;
  }
  if (chooses_rules(mode)) kept_.rule_set = reported.rule_set;
  if (!has_end(mode)) return;
  kept_.goals = reported.goals;
  kept_.sets = reported.sets;
  kept_.match_ms = reported.match_ms;
  kept_.change_sides = reported.change_sides;
}

wire::Game GameMenu::wanted() const {
  return asked_for(kept_);
}

int GameMenu::rows() const {
  return row_count;
}

bool GameMenu::fixed(int row) const {
  const foosball::Mode mode = mode_of(kept_);
  if (!may_change_) return true;
  if (row == row_level || row == row_style) return !chooses_opponent(mode);
  if (row == row_rules) return !chooses_rules(mode);
  if (row >= row_goals && row <= row_sides) return !has_end(mode);
  return row == row_begin && !reported_->waits;
}

MenuRow GameMenu::row(int row) const {
  const wire::Game game = wanted();
  const foosball::GameSetup setup = setup_of(game);
  const foosball::Rules rules = rules_of(setup);
  const bool no_end = setup.mode == foosball::Mode::training;
  const auto number = [](int n) { return std::to_string(n); };
  const bool day = setup.mode == foosball::Mode::challenge;
  const bool day_is_known =
      day && reported_->mode == game.mode;  // the opponent of the day is known
  const int level = day_is_known ? reported_->level : game.level,
            style = day_is_known ? reported_->style : game.style;
  const char* level_by_mode = day ? N_("of the day") : N_("stronger with each match");
  const bool known = chooses_opponent(setup.mode) || day_is_known;
  switch (row) {
    case row_mode:
      return {N_("Mode"), kModeNames[game.mode]};
    case row_level:
      if (!known) return {N_("Computer's level"), level_by_mode};
      return {.label = N_("Computer's level"), .value = number(level), .translate_value = false};
    case row_style:
      if (!known && day) return {N_("Computer's style"), N_("of the day")};
      return {N_("Computer's style"), kStyleNames[static_cast<std::size_t>(style)]};
    case row_rules:
      return {N_("Rules"), kRulesNames[game.rule_set]};
    case row_goals:
      if (no_end || (rules.match_seconds > 0.0 && rules.goals_to_win == foosball::kMaxGoals))
        return {N_("Goals that win a set"), N_("no limit")};
      return {.label = N_("Goals that win a set"),
              .value = number(rules.goals_to_win),
              .translate_value = false};
    case row_sets:
      if (no_end) return {N_("Best of how many sets"), "-"};
      return {.label = N_("Best of how many sets"),
              .value = number(2 * rules.sets_to_win - 1),
              .translate_value = false};
    case row_minutes: {
      const auto ms = static_cast<std::uint32_t>(rules.match_seconds * 1000.0 + 0.5);
      if (ms == 0) return {N_("Minutes of a set"), N_("no limit")};
      return {.label = N_("Minutes of a set"), .value = minutes_text(ms), .translate_value = false};
    }
    case row_sides:
      return {N_("Change sides between sets"), game.change_sides ? N_("on") : N_("off")};
    default:
      return {N_("End this match, begin the one chosen"),
              reported_->waits ? "" : N_("no game is waiting")};
  }
}

std::string GameMenu::note(int row) const {
  if (!may_change_) return N_("Only the host chooses what is played; you see it as it is.");
  if (reported_->waits && row != row_begin)
    return N_(
        "A match is in play: your choice takes effect in the next one. The last row ends this "
        "match at once.");
  if (row == row_mode) return kModeNotes[kept_.mode];
  if (row == row_begin) return N_("Back to the logo, as a restart does: this match has no result.");
  if (fixed(row)) return N_("The mode decides this.");
  if (row == row_level) return N_("1 is calm, 5 is hard to beat.");
  if (row == row_style)
    return N_(
        "The wall guards its goal, the shooter strikes at once, the passer plays forward, the "
        "gambler takes risks.");
  if (row == row_rules)
    return N_(
        "arcade: first to five. Tournament: sets, two touches from the serve, time limits on "
        "the ball.");
  if (row == row_minutes) return N_("When they are over, the leading team wins.");
  return {};
}

MenuPage GameMenu::page(int chosen) const {
  MenuPage page;
  page.title = N_("Game");
  page.chosen = chosen;
  for (int i = 0; i < row_count; ++i) {
    if (!reported_) {
      page.rows.push_back({.label = N_("Mode"), .value = "...", .translate_value = false});
      break;
    }
    page.rows.push_back(row(i));
    page.rows.back().fixed = fixed(i);
  }
  if (reported_ && chosen >= 0) page.note = note(chosen);
  page.detail = refused_;
  return page;
}

// A set with a time limit may also have no goal limit.
void GameMenu::change_goals(int way) {
  const int now = rules_of(setup_of(kept_)).goals_to_win;
  const bool timed = kept_.match_ms > 0;
  const bool none = timed && kept_.goals == 0;
  const int min = timed ? 0 : 1;
  const int next = none ? std::max(0, way) : now + way;
  kept_.goals = static_cast<std::uint8_t>(std::clamp(next, min, foosball::kMaxGoals));
}

void GameMenu::change(int row, int way) {
  const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
  switch (row) {
    case row_mode:
      kept_.mode = byte(turned(kept_.mode, way, wire::kModeCount));
      break;
    case row_level:
      kept_.level = byte(std::clamp(kept_.level + way, 1, kLevels));
      break;
    case row_style:
      kept_.style = byte(turned(kept_.style, way, wire::kStyleCount + 1));
      if (kept_.level == 0) kept_.level = 1;
      break;
    case row_rules:
      kept_.rule_set = byte(turned(kept_.rule_set, way, wire::kRuleSetCount));
      kept_.goals = kept_.sets = 0;  // as the rules define them
      break;
    case row_goals:
      change_goals(way);
      break;
    case row_sets: {
      const int sets = 2 * rules_of(setup_of(kept_)).sets_to_win - 1;
      kept_.sets = byte(std::clamp(sets + 2 * way, 1, foosball::kMaxSets));
      break;
    }
    case row_minutes: {
      const auto of = [](std::uint32_t m) { return m * kMinuteMs; };
      const auto next = std::ranges::upper_bound(kMinutes, kept_.match_ms, {}, of);
      const auto here = std::ranges::lower_bound(kMinutes, kept_.match_ms, {}, of);
      const auto last = static_cast<int>(kMinutes.size()) - 1;
      const auto at = static_cast<int>((way > 0 ? next : here) - kMinutes.begin());
      const int place = std::clamp(way > 0 ? at + way - 1 : at + way, 0, last);
      const bool was_timed = kept_.match_ms > 0;
      kept_.match_ms = kMinutes[static_cast<std::size_t>(place)] * kMinuteMs;
      // Without a time limit the rules' number of goals, with one no goal limit.
      if (was_timed != (kept_.match_ms > 0)) kept_.goals = 0;
      break;
    }
    case row_sides:
      kept_.change_sides = !kept_.change_sides;
      break;
    default:
      break;
  }
}

bool GameMenu::step(int row, const MenuSteps& steps) {
  const int way = steps.right != 0 ? steps.right : steps.confirm ? 1 : 0;
  if (way == 0 || row < 0 || row >= row_count || !reported_ || fixed(row)) return false;
  if (row == row_begin) return steps.confirm;
  const wire::Game before = kept_;
  change(row, way);
  if (kept_ == before) return false;
  asking_ = stepped_ = true;
  tries_ = 0;
  return false;
}

std::optional<wire::Game> GameMenu::ask(std::int64_t now_us) {
  if (std::exchange(stepped_, false)) next_us_ = now_us + kSettleUs;
  if (!asking_ || now_us < next_us_) return std::nullopt;
  if (tries_ == kTries) {  // the server has given a reason, or the link is bad
    asking_ = false;
    return std::nullopt;
  }
  ++tries_;
  next_us_ = now_us + kAgainUs;
  return wanted();
}

}  // namespace client
