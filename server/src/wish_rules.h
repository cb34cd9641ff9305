// Which wishes of a client count: those that exist, that it may have, and not too many of them.
#pragma once

#include <cstdint>

#include "foosball/match.h"
#include "wire/control.h"

namespace server {

bool well_formed(const wire::Wish& wish);

// A player for the own team; a watcher (team wire::kWatchOnly) at the server's machine for all, one
// elsewhere for nothing.
bool may_wish(std::uint8_t team, bool at_this_machine, const foosball::Command& wish);

// One client's: so many at once, then so many a second. A hand at the keys needs no more, and a
// restart and what follows it costs the tick more than play does.
class WishAllowance {
 public:
  static constexpr int kAtOnce = 16;
  static constexpr std::int64_t kEveryUs = 50'000;

  // False: too many.
  bool take(std::int64_t now_us);

 private:
  std::int64_t paid_until_us_ = 0;  // each wish moves it on by kEveryUs
};

}  // namespace server
