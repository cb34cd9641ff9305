#include "door.h"

#include <algorithm>

namespace server {

bool RateLimit::take(std::int64_t now_us) {
  const std::int64_t paid = std::max(paid_until_us_, now_us) + every_us_;
  if (paid - now_us > at_once_ * every_us_) return false;
  paid_until_us_ = paid;
  return true;
}

const std::string& RateLimits::account(const std::string& name) const {
  static const std::string kTheOthers;
  return paid_until_us_.size() < kNames || paid_until_us_.contains(name) ? name : kTheOthers;
}

bool RateLimits::may_take(const std::string& name, std::int64_t now_us) const {
  const auto known = paid_until_us_.find(account(name));
  return known == paid_until_us_.end() ||
         known->second + every_us_ - now_us <= at_once_ * every_us_;
}

void RateLimits::take(const std::string& name, std::int64_t now_us) {
  std::erase_if(paid_until_us_, [&](const auto& entry) { return entry.second <= now_us; });
  std::int64_t& paid = paid_until_us_[account(name)];
  paid = std::max(paid, now_us) + every_us_;
}

void RateLimits::give_back(const std::string& name) {
  const auto known = paid_until_us_.find(account(name));
  if (known != paid_until_us_.end()) known->second -= every_us_;
}

bool PasswordTries::charge(const os::SocketAddress& from, std::int64_t now_us) {
  const std::string machine = from.machine(), network = from.network();
  if (!networks_.may_take(network, now_us) || !machines_.may_take(machine, now_us)) return false;
  networks_.take(network, now_us);
  machines_.take(machine, now_us);
  return true;
}

void PasswordTries::refund(const os::SocketAddress& to) {
  networks_.give_back(to.network());
  machines_.give_back(to.machine());
}

}  // namespace server
