// Rate limits for untrusted clients: log lines that they cause, and password attempts per machine
// and network.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "os/socket_address.h"

namespace server {

// Allows a burst, then a steady rate.
class RateLimit {
 public:
  RateLimit(int at_once, std::int64_t every_us) : at_once_(at_once), every_us_(every_us) {}
  // False: over the limit.
  bool take(std::int64_t now_us);

 private:
  int at_once_;
  std::int64_t every_us_;
  std::int64_t paid_until_us_ = 0;  // each event advances it by every_us_
};

// One RateLimit per name.
class RateLimits {
 public:
  // Number of names with their own limit; all further names share one.
  static constexpr std::size_t kNames = 1024;

  RateLimits(int at_once, std::int64_t every_us) : at_once_(at_once), every_us_(every_us) {}
  bool may_take(const std::string& name, std::int64_t now_us) const;
  void take(const std::string& name, std::int64_t now_us);
  void give_back(const std::string& name);

 private:
  const std::string& account(const std::string& name) const;

  int at_once_;
  std::int64_t every_us_;
  std::map<std::string, std::int64_t> paid_until_us_;
};

// Limits password attempts. An attempt is counted when it begins, so that parallel connections
// cannot avoid the limit, and refunded if the password was right. It counts for the machine, so
// that neighbours do not lock each other out, and for its network, so that an owner of 2^64
// addresses also has few attempts.
class PasswordTries {
 public:
  // Burst size: the max number of seats of one address.
  static constexpr int kAtOnce = 8, kNetworkAtOnce = 32;
  static constexpr std::int64_t kEveryUs = 10'000'000, kNetworkEveryUs = 2'500'000;

  // False: over the limit.
  bool charge(const os::SocketAddress& from, std::int64_t now_us);
  void refund(const os::SocketAddress& to);

 private:
  RateLimits machines_{kAtOnce, kEveryUs}, networks_{kNetworkAtOnce, kNetworkEveryUs};
};

}  // namespace server
