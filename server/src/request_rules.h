// Decides which requests of a client count: valid ones that it is allowed to make, within a rate
// limit.
#pragma once

#include <cstdint>

#include "door.h"
#include "foosball/match.h"
#include "wire/control.h"
#include "wire/enums.h"

namespace server {

bool well_formed(const wire::MatchRequest& request);
// The match command of the request. Precondition: well_formed(). The value is 0 for a kind that
// takes none, so that all votes for it are equal.
foosball::Command command_of(const wire::MatchRequest& request);

// The ruling on a well-formed request. A host's request, or one that concerns only the client's own
// team, is granted. What concerns both teams needs a vote. A watcher gets nothing.
enum class Ruling : std::uint8_t { no, vote, yes };
Ruling rule(wire::Role role, std::uint8_t team, const foosball::Command& request);

// Rate limit of one client: a burst, then a steady rate. It suffices for a person at the keys. It
// is needed because a restart costs the tick more than play does.
class RequestAllowance : public RateLimit {
 public:
  static constexpr int kAtOnce = 16;
  static constexpr std::int64_t kEveryUs = 50'000;
  RequestAllowance() : RateLimit(kAtOnce, kEveryUs) {}
};

}  // namespace server
