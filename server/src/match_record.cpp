#include "match_record.h"

#include <algorithm>
#include <cmath>

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

std::uint32_t milliseconds(double seconds) {
  return static_cast<std::uint32_t>(std::llround(std::clamp(seconds, 0.0, 4.0e6) * 1000.0));
}

}  // namespace

wire::JournalRod to_grid(const cabinet::RodInput& input) {
  return wire::quantise_rod({input.slide, input.angle, input.slide_rate, input.angle_rate,
                             input.status == cabinet::RodStatus::live});
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
