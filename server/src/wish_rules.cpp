#include "wish_rules.h"

#include <algorithm>

namespace server {
namespace {

constexpr auto kCommandKinds = static_cast<std::uint8_t>(foosball::Command::Kind::restart) + 1;

}  // namespace

bool well_formed(const wire::Wish& wish) {
  using Kind = foosball::Command::Kind;
  if (wish.kind >= kCommandKinds || wish.team >= foosball::kTeams) return false;
  switch (static_cast<Kind>(wish.kind)) {
    case Kind::choose_character:
      return wish.value < foosball::kCharacters;
    case Kind::pause:
      return wish.value <= 1;
    case Kind::push:
    case Kind::restart:
      return true;
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
