#include "server/match_record.h"

#include <algorithm>
#include <cmath>

#include "rod_desk.h"
#include "wire/enums.h"
#include "wire/limits.h"

namespace server {

// The wire counts foosball's and cabinet's enumerations without knowing them; here both are known.
static_assert(wire::kTeamCount == foosball::kTeams);
static_assert(wire::kLayoutCount == foosball::kLayouts);
static_assert(wire::kScreenCount == foosball::kScreens);
static_assert(wire::kCharacterCount == foosball::kCharacters);
static_assert(wire::kEventKindCount == foosball::kEventKinds);
static_assert(wire::kCommandKindCount ==
              static_cast<unsigned>(foosball::Command::Kind::restart) + 1);
static_assert(wire::kMenOnRod == foosball::kMaxMenOnRod);
static_assert(wire::kRodStatusCount == static_cast<unsigned>(cabinet::RodStatus::held) + 1);

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
static_assert(same(wire::WishKind::push, foosball::Command::Kind::push));
static_assert(same(wire::WishKind::choose_character, foosball::Command::Kind::choose_character));
static_assert(same(wire::WishKind::pause, foosball::Command::Kind::pause));
static_assert(same(wire::WishKind::restart, foosball::Command::Kind::restart));
static_assert(same(wire::RodStatus::absent, cabinet::RodStatus::absent));
static_assert(same(wire::RodStatus::live, cabinet::RodStatus::live));
static_assert(same(wire::RodStatus::held, cabinet::RodStatus::held));
static_assert(same(wire::RodSource::none, RodDriver::none));
static_assert(same(wire::RodSource::cabinet, RodDriver::cabinet));
static_assert(same(wire::RodSource::client, RodDriver::client));
static_assert(same(wire::RodSource::computer, RodDriver::computer));
static_assert(same(wire::RodSource::replay, RodDriver::replay));

std::uint32_t milliseconds(double seconds) {
  return static_cast<std::uint32_t>(std::llround(std::clamp(seconds, 0.0, 4.0e6) * 1000.0));
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
  header.goals_to_win = static_cast<std::uint32_t>(match.rules.goals_to_win);
  header.max_goals = static_cast<std::uint32_t>(match.rules.max_goals);
  header.dead_ball_ms = milliseconds(match.rules.dead_ball_seconds);
  header.ceremony_ms = milliseconds(match.rules.ceremony_seconds);
  header.end_ms = milliseconds(match.rules.end_seconds);
  return header;
}

foosball::MatchDesc from_header(const wire::JournalHeader& header) {
  foosball::MatchDesc match;
  match.layout = static_cast<foosball::Layout>(header.layout);
  match.seed = header.seed;
  match.rules.goals_to_win = static_cast<int>(header.goals_to_win);
  match.rules.max_goals = static_cast<int>(header.max_goals);
  match.rules.dead_ball_seconds = header.dead_ball_ms / 1000.0;
  match.rules.ceremony_seconds = header.ceremony_ms / 1000.0;
  match.rules.end_seconds = header.end_ms / 1000.0;
  return match;
}

wire::JournalCommand to_record(const foosball::Command& command) {
  return {static_cast<std::uint8_t>(command.kind), command.team, command.value};
}

foosball::Command from_record(const wire::JournalCommand& command) {
  return {static_cast<foosball::Command::Kind>(command.kind), command.team, command.value};
}

}  // namespace server
