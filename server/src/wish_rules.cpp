#include "wish_rules.h"

#include <algorithm>

#include "wire/limits.h"

namespace server {
namespace {

// The kinds after it are the server's own.
constexpr auto kWishKinds = static_cast<std::uint8_t>(foosball::Command::Kind::feed) + 1;
static_assert(kWishKinds == wire::kWishKindCount);

}  // namespace

bool well_formed(const wire::Wish& wish) {
  using Kind = foosball::Command::Kind;
  if (wish.kind >= kWishKinds || wish.team >= foosball::kTeams) return false;
  switch (static_cast<Kind>(wish.kind)) {
    case Kind::choose_character:
      return wish.value < foosball::kCharacters;
    case Kind::pause:
      return wish.value <= 1;
    case Kind::feed:
      return wish.value < foosball::kFeedValues;
    case Kind::push:
    case Kind::restart:
    case Kind::time_out:
      return true;
    case Kind::seat:
    case Kind::touch:
      return false;
  }
  return false;
}

bool may_wish(std::uint8_t team, bool at_this_machine, const foosball::Command& wish) {
  using Kind = foosball::Command::Kind;
  if (team == wire::kWatchOnly) return at_this_machine;
  return wish.kind == Kind::pause || wish.kind == Kind::restart || wish.team == team;
}

bool WishAllowance::take(std::int64_t now_us) {
  const std::int64_t paid = std::max(paid_until_us_, now_us) + kEveryUs;
  if (paid - now_us > kAtOnce * kEveryUs) return false;
  paid_until_us_ = paid;
  return true;
}

}  // namespace server
