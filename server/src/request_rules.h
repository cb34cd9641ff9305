// Which requests of a client count: those that exist, that it may have, and not too many of them.
#pragma once

#include <cstdint>

#include "door.h"
#include "foosball/match.h"
#include "wire/control.h"
#include "wire/enums.h"

namespace server {

bool well_formed(const wire::MatchRequest& request);
// What it asks of the match. Precondition: well_formed(). A kind that takes no value has none, so
// that all who ask for it ask one question.
foosball::Command command_of(const wire::MatchRequest& request);

// What becomes of a well-formed request: a host's and one for the own team is done, what concerns
// both teams is put to the vote, a watcher has none.
enum class Ruling : std::uint8_t { no, vote, yes };
Ruling rule(wire::Role role, std::uint8_t team, const foosball::Command& request);

// One client's: so many at once, then so many a second. A hand at the keys needs no more, and a
// restart and what follows it costs the tick more than play does.
class RequestAllowance : public RateLimit {
 public:
  static constexpr int kAtOnce = 16;
  static constexpr std::int64_t kEveryUs = 50'000;
  RequestAllowance() : RateLimit(kAtOnce, kEveryUs) {}
};

}  // namespace server
