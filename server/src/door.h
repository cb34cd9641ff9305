// Limits against crowds: how many lines a stranger can cause in the log, and how often an address
// may give a wrong password.
#pragma once

#include <cstdint>
#include <map>
#include <string>

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

// Wrong passwords, by network. The exchange gives one guess a connection; this makes guesses slow.
class WrongPasswords {
 public:
  static constexpr int kAtOnce = 5;
  static constexpr std::int64_t kEveryUs = 10'000'000;
  // Networks remembered, each by itself; all others together count as one.
  static constexpr std::size_t kNetworks = 1024;

  bool may_try(const std::string& network, std::int64_t now_us) const;
  void note(const std::string& network, std::int64_t now_us);

 private:
  const std::string& account(const std::string& network) const;

  std::map<std::string, std::int64_t> paid_until_us_;
};

}  // namespace server
