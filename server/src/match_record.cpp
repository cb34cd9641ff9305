#include "server/match_record.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "characters/record.h"
#include "rod_desk.h"
#include "wire/enums.h"
#include "wire/limits.h"

namespace server {

// wire mirrors the enumerations of foosball and cabinet without knowing them; this file knows both.
static_assert(wire::kTeamCount == foosball::kTeams);
static_assert(wire::kLayoutCount == foosball::kLayouts);
static_assert(wire::kScreenCount == foosball::kScreens);
static_assert(wire::kEventKindCount == foosball::kEventKinds);
static_assert(wire::kCommandKindCount == foosball::kCommandKinds);
static_assert(wire::kTuningCount == foosball::kTuningValues);
static_assert(wire::kRuleSetCount == foosball::kRuleSets);
static_assert(wire::kModeCount == foosball::kModes);
static_assert(wire::kFoulCount == foosball::kFouls);
static_assert(wire::kSpinRuleCount == foosball::kSpinRules);
static_assert(wire::kRungCount == foosball::kLadderRungs);
static_assert(wire::kMenOnRod == foosball::kMaxMenOnRod);
static_assert(wire::kRodStatusCount == static_cast<unsigned>(cabinet::RodStatus::held) + 1);
static_assert(wire::kDeviceStateCount == static_cast<unsigned>(cabinet::DeviceState::over) + 1);

namespace {

template <class Wire, class Own>
constexpr bool same(Wire wire, Own own) {
  return static_cast<unsigned>(wire) == static_cast<unsigned>(own);
}
static_assert(same(wire::Screen::logo, foosball::Screen::logo));
static_assert(same(wire::Screen::selection, foosball::Screen::selection));
static_assert(same(wire::Screen::play, foosball::Screen::play));
static_assert(same(wire::Screen::ceremony, foosball::Screen::ceremony));
static_assert(same(wire::Screen::end, foosball::Screen::end));
static_assert(same(wire::EventKind::man_hit, foosball::EventKind::man_hit));
static_assert(same(wire::EventKind::wall_hit, foosball::EventKind::wall_hit));
static_assert(same(wire::EventKind::field_hit, foosball::EventKind::field_hit));
static_assert(same(wire::EventKind::goal, foosball::EventKind::goal));
static_assert(same(wire::EventKind::serve, foosball::EventKind::serve));
static_assert(same(wire::EventKind::dead_ball, foosball::EventKind::dead_ball));
static_assert(same(wire::EventKind::ball_out, foosball::EventKind::ball_out));
static_assert(same(wire::EventKind::screen, foosball::EventKind::screen));
static_assert(same(wire::EventKind::match_won, foosball::EventKind::match_won));
static_assert(same(wire::EventKind::shot, foosball::EventKind::shot));
static_assert(same(wire::EventKind::foul, foosball::EventKind::foul));
static_assert(same(wire::EventKind::time_out, foosball::EventKind::time_out));
static_assert(same(wire::EventKind::set_won, foosball::EventKind::set_won));
static_assert(same(wire::EventKind::match_drawn, foosball::EventKind::match_drawn));
static_assert(same(wire::RuleSet::arcade, foosball::RuleSet::arcade));
static_assert(same(wire::RuleSet::itsf, foosball::RuleSet::itsf));
static_assert(same(wire::Mode::match, foosball::Mode::match));
static_assert(same(wire::Mode::training, foosball::Mode::training));
static_assert(same(wire::Mode::challenge, foosball::Mode::challenge));
static_assert(same(wire::Mode::ladder, foosball::Mode::ladder));
static_assert(same(wire::Foul::possession, foosball::Foul::possession));
static_assert(same(wire::Foul::spin, foosball::Foul::spin));
static_assert(same(wire::Foul::jarring, foosball::Foul::jarring));
static_assert(same(wire::Foul::technical, foosball::Foul::technical));
static_assert(same(wire::Foul::time_out, foosball::Foul::time_out));
static_assert(same(wire::Foul::serve, foosball::Foul::serve));
static_assert(same(wire::RequestKind::push, foosball::Command::Kind::push));
static_assert(same(wire::RequestKind::choose_character, foosball::Command::Kind::choose_character));
static_assert(same(wire::RequestKind::pause, foosball::Command::Kind::pause));
static_assert(same(wire::RequestKind::restart, foosball::Command::Kind::restart));
static_assert(same(wire::RequestKind::time_out, foosball::Command::Kind::time_out));
static_assert(same(wire::RequestKind::feed, foosball::Command::Kind::feed));
static_assert(same(wire::RequestKind::seat, foosball::Command::Kind::seat));
static_assert(same(wire::RequestKind::touch, foosball::Command::Kind::touch));
static_assert(same(wire::RequestKind::tune, foosball::Command::Kind::tune));
static_assert(same(wire::RequestKind::set_up, foosball::Command::Kind::set_up));
static_assert(same(wire::RodStatus::absent, cabinet::RodStatus::absent));
static_assert(same(wire::RodStatus::live, cabinet::RodStatus::live));
static_assert(same(wire::RodStatus::held, cabinet::RodStatus::held));
static_assert(same(wire::DeviceState::missing, cabinet::DeviceState::missing));
static_assert(same(wire::DeviceState::refused, cabinet::DeviceState::refused));
static_assert(same(wire::DeviceState::silent, cabinet::DeviceState::silent));
static_assert(same(wire::DeviceState::garbled, cabinet::DeviceState::garbled));
static_assert(same(wire::DeviceState::live, cabinet::DeviceState::live));
static_assert(same(wire::DeviceState::over, cabinet::DeviceState::over));
static_assert(same(wire::RodSource::none, RodDriver::none));
static_assert(same(wire::RodSource::cabinet, RodDriver::cabinet));
static_assert(same(wire::RodSource::client, RodDriver::client));
static_assert(same(wire::RodSource::computer, RodDriver::computer));
static_assert(same(wire::RodSource::replay, RodDriver::replay));

std::uint32_t milliseconds(double seconds) {
  return static_cast<std::uint32_t>(std::llround(std::clamp(seconds, 0.0, 4.0e6) * 1000.0));
}

// Precondition: in range.
wire::JournalSetup to_record(const foosball::GameSetup& setup) {
  return {static_cast<std::uint8_t>(setup.mode),
          static_cast<std::uint8_t>(setup.rules),
          static_cast<std::uint8_t>(setup.goals),
          static_cast<std::uint8_t>(setup.sets),
          setup.match_ms,
          setup.change_sides,
          setup.date};
}

foosball::GameSetup from_record(const wire::JournalSetup& setup) {
  return {static_cast<foosball::Mode>(setup.mode),
          static_cast<foosball::RuleSet>(setup.rule_set),
          setup.goals,
          setup.sets,
          setup.match_ms,
          setup.change_sides,
          setup.date};
}

}  // namespace

wire::JournalRod to_grid(const cabinet::RodInput& input) {
  return wire::quantise_rod({input.slide, input.angle, input.slide_rate, input.angle_rate,
                             input.status == cabinet::RodStatus::live});
}

wire::JournalRod to_grid(const foosball::RodTarget& target) {
  return wire::quantise_rod(
      {target.slide, target.angle, target.slide_rate, target.angle_rate, target.live});
}

foosball::RodTarget from_grid(const wire::JournalRod& rod) {
  const wire::RodTargetValues values = wire::dequantise_rod(rod);
  return {values.slide, values.angle, values.slide_rate, values.angle_rate, values.live};
}

wire::JournalHeader to_header(const foosball::MatchDesc& match) {
  wire::JournalHeader header;
  header.layout = static_cast<std::uint8_t>(match.layout);
  header.seed = match.seed;
  const foosball::Rules& rules = match.rules;
  header.mode = static_cast<std::uint8_t>(match.mode);
  header.rule_set = static_cast<std::uint8_t>(rules.set);
  header.goals_to_win = static_cast<std::uint32_t>(rules.goals_to_win);
  header.max_goals = static_cast<std::uint32_t>(rules.max_goals);
  header.lead = static_cast<std::uint32_t>(rules.lead);
  header.sets_to_win = static_cast<std::uint32_t>(rules.sets_to_win);
  header.match_ms = milliseconds(rules.match_seconds);
  header.golden_goal = rules.golden_goal;
  header.change_sides = rules.change_sides;
  header.jarring = rules.jarring;
  header.spin = static_cast<std::uint8_t>(rules.spin);
  header.time_outs = static_cast<std::uint32_t>(rules.time_outs);
  header.time_out_ms = milliseconds(rules.time_out_seconds);
  header.dead_ball_ms = milliseconds(rules.dead_ball_seconds);
  header.still_ms = milliseconds(rules.still_seconds);
  header.possession_midfield_ms = milliseconds(rules.possession_midfield_seconds);
  header.possession_ms = milliseconds(rules.possession_seconds);
  header.ceremony_ms = milliseconds(rules.ceremony_seconds);
  header.end_ms = milliseconds(rules.end_seconds);
  header.idle_ms = milliseconds(rules.idle_seconds);
  header.attract_ms = milliseconds(rules.attract_seconds);
  for (std::size_t i = 0; i < header.tuning.size(); ++i) {
    const foosball::TuningField& field = foosball::kTuningFields[i];
    header.tuning[i] = std::bit_cast<std::uint64_t>(match.tuning.*field.value);
  }
  header.characters = characters::to_record(match.characters).characters;
  return header;
}

foosball::MatchDesc from_header(const wire::JournalHeader& header) {
  foosball::MatchDesc match;
  match.layout = static_cast<foosball::Layout>(header.layout);
  match.seed = header.seed;
  match.mode = static_cast<foosball::Mode>(header.mode);
  foosball::Rules& rules = match.rules;
  rules.set = static_cast<foosball::RuleSet>(header.rule_set);
  rules.goals_to_win = static_cast<int>(header.goals_to_win);
  rules.max_goals = static_cast<int>(header.max_goals);
  rules.lead = static_cast<int>(header.lead);
  rules.sets_to_win = static_cast<int>(header.sets_to_win);
  rules.match_seconds = header.match_ms / 1000.0;
  rules.golden_goal = header.golden_goal;
  rules.change_sides = header.change_sides;
  rules.jarring = header.jarring;
  rules.spin = static_cast<foosball::SpinRule>(header.spin);
  rules.time_outs = static_cast<int>(header.time_outs);
  rules.time_out_seconds = header.time_out_ms / 1000.0;
  rules.dead_ball_seconds = header.dead_ball_ms / 1000.0;
  rules.still_seconds = header.still_ms / 1000.0;
  rules.possession_midfield_seconds = header.possession_midfield_ms / 1000.0;
  rules.possession_seconds = header.possession_ms / 1000.0;
  rules.ceremony_seconds = header.ceremony_ms / 1000.0;
  rules.end_seconds = header.end_ms / 1000.0;
  rules.idle_seconds = header.idle_ms / 1000.0;
  rules.attract_seconds = header.attract_ms / 1000.0;
  for (std::size_t i = 0; i < header.tuning.size(); ++i) {
    match.tuning.*foosball::kTuningFields[i].value = std::bit_cast<double>(header.tuning[i]);
  }
  // Invalid characters become an empty list, which Match::create rejects.
  match.characters = characters::from_record({header.characters}).value_or(foosball::Characters{});
  return match;
}

wire::JournalCommand to_record(const foosball::Command& command) {
  const bool tune = command.kind == foosball::Command::Kind::tune;
  const bool set_up = command.kind == foosball::Command::Kind::set_up;
  return {static_cast<std::uint8_t>(command.kind), command.team, command.value,
          tune ? std::bit_cast<std::uint64_t>(command.amount) : 0,
          set_up ? to_record(command.setup) : wire::JournalSetup{}};
}

foosball::Command from_record(const wire::JournalCommand& command) {
  return {static_cast<foosball::Command::Kind>(command.kind), command.team, command.value,
          std::bit_cast<double>(command.amount), from_record(command.setup)};
}

}  // namespace server
