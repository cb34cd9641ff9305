// Limits against crowds: how many lines a stranger can cause in the log, and how many passwords a
// machine and a network may try.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "os/socket_address.h"

namespace server {

// So many at once, then so many a second.
class RateLimit {
 public:
  RateLimit(int at_once, std::int64_t every_us) : at_once_(at_once), every_us_(every_us) {}
  // False: too many.
  bool take(std::int64_t now_us);

 private:
  int at_once_;
  std::int64_t every_us_;
  std::int64_t paid_until_us_ = 0;  // each one moves it on by every_us_
};

// A RateLimit for each of many, by name.
class RateLimits {
 public:
  // Names remembered, each with its own account; all others together have one.
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

// Passwords tried. A try is charged when it begins, so that many connections at once are no way
// round the limit, and refunded when the password was right. Charged twice: to the machine, so that
// neighbours do not lock each other out, and to its network, so that whoever has 2^64 addresses
// has few guesses all the same.
class PasswordTries {
 public:
  // As many at once as there may be seats of one address.
  static constexpr int kAtOnce = 8, kNetworkAtOnce = 32;
  static constexpr std::int64_t kEveryUs = 10'000'000, kNetworkEveryUs = 2'500'000;

  // False: too many.
  bool charge(const os::SocketAddress& from, std::int64_t now_us);
  void refund(const os::SocketAddress& to);

 private:
  RateLimits machines_{kAtOnce, kEveryUs}, networks_{kNetworkAtOnce, kNetworkEveryUs};
};

}  // namespace server
