#include "door.h"

#include <algorithm>

namespace server {

bool RateLimit::take(std::int64_t now_us) {
  const std::int64_t paid = std::max(paid_until_us_, now_us) + every_us_;
  if (paid - now_us > at_once_ * every_us_) return false;
  paid_until_us_ = paid;
  return true;
}

bool WrongPasswords::may_try(const std::string& network, std::int64_t now_us) const {
  const auto known = paid_until_us_.find(network);
  return known == paid_until_us_.end() || known->second + kEveryUs - now_us <= kAtOnce * kEveryUs;
}

void WrongPasswords::note(const std::string& network, std::int64_t now_us) {
  std::erase_if(paid_until_us_, [&](const auto& entry) { return entry.second <= now_us; });
  if (paid_until_us_.size() >= kNetworks && !paid_until_us_.contains(network)) return;
  std::int64_t& paid = paid_until_us_[network];
  paid = std::max(paid, now_us) + kEveryUs;
}

}  // namespace server
