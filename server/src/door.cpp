#include "door.h"

#include <algorithm>

namespace server {

bool RateLimit::take(std::int64_t now_us) {
  const std::int64_t paid = std::max(paid_until_us_, now_us) + every_us_;
  if (paid - now_us > at_once_ * every_us_) return false;
  paid_until_us_ = paid;
  return true;
}

// Where no more networks can be remembered, all that are not share one account.
const std::string& WrongPasswords::account(const std::string& network) const {
  static const std::string kTheOthers;
  return paid_until_us_.size() < kNetworks || paid_until_us_.contains(network) ? network
                                                                               : kTheOthers;
}

bool WrongPasswords::may_try(const std::string& network, std::int64_t now_us) const {
  const auto known = paid_until_us_.find(account(network));
  return known == paid_until_us_.end() || known->second + kEveryUs - now_us <= kAtOnce * kEveryUs;
}

void WrongPasswords::note(const std::string& network, std::int64_t now_us) {
  std::erase_if(paid_until_us_, [&](const auto& entry) { return entry.second <= now_us; });
  std::int64_t& paid = paid_until_us_[account(network)];
  paid = std::max(paid, now_us) + kEveryUs;
}

}  // namespace server
