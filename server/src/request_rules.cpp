#include "request_rules.h"

#include "wire/limits.h"

namespace server {
namespace {

// The kinds after it are reserved for the server.
constexpr auto kRequestKinds = static_cast<std::uint8_t>(foosball::Command::Kind::feed) + 1;
static_assert(kRequestKinds == wire::kRequestKindCount);

}  // namespace

bool well_formed(const wire::MatchRequest& request) {
  using Kind = foosball::Command::Kind;
  if (request.team >= foosball::kTeams) return false;
  switch (static_cast<Kind>(request.kind)) {
    case Kind::choose_character:
      return request.value < foosball::kMaxCharacters;
    case Kind::pause:
      return request.value <= 1;
    case Kind::feed:
      return request.value < foosball::kFeedValues;
    case Kind::push:
    case Kind::restart:
    case Kind::time_out:
      return true;
    case Kind::tune:
      return request.value < foosball::kTuningValues &&
             in_range(foosball::kTuningFields[request.value], request.amount);
    case Kind::seat:
    case Kind::touch:
    case Kind::set_up:
      return false;
  }
  return false;
}

foosball::Command command_of(const wire::MatchRequest& request) {
  using Kind = foosball::Command::Kind;
  const auto kind = static_cast<Kind>(request.kind);
  const bool without_value = kind == Kind::push || kind == Kind::restart || kind == Kind::time_out;
  return {kind, request.team, without_value ? std::uint8_t{0} : request.value, request.amount};
}

Ruling rule(wire::Role role, std::uint8_t team, const foosball::Command& request) {
  using Kind = foosball::Command::Kind;
  // Tuning changes the game for all: only the host may.
  if (request.kind == Kind::tune) return role == wire::Role::host ? Ruling::yes : Ruling::no;
  const bool for_all = request.kind == Kind::pause || request.kind == Kind::restart;
  if (role == wire::Role::watcher) return Ruling::no;
  if (role == wire::Role::player) {
    if (team == wire::kWatchOnly) return Ruling::no;
    return for_all ? Ruling::vote : request.team == team ? Ruling::yes : Ruling::no;
  }
  // A host who plays does not decide for the other team.
  return for_all || team == wire::kWatchOnly || request.team == team ? Ruling::yes : Ruling::no;
}

}  // namespace server
