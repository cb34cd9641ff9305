// Votes against a player. More than half of the machines of the others who play decide, and never
// one alone: against an opponent there is the host. Who was voted out has no rods again in this
// match, nor has anybody else who comes from that machine meanwhile.
//
// Time is an argument; texts name machines (os::SocketAddress::machine).
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "door.h"

namespace server {

class KickVotes {
 public:
  static constexpr std::int64_t kOpenUs = 20'000'000;   // from the first vote on
  static constexpr std::int64_t kEveryUs = 60'000'000;  // a machine begins one vote in so long
  static constexpr int kFewest = 2;                     // votes

  struct Count {
    bool taken = false;  // false: it would begin a vote, and began one just now
    int votes = 0, needed = 0;
    bool passed() const { return taken && votes >= needed; }
  };
  // voters: the machines of all others who play now, each once, the voter's among them. A vote that
  // passed is over. Precondition: voters.size() >= kFewest.
  Count cast(const std::string& voter, std::uint32_t target, const std::string& target_machine,
             std::span<const std::string> voters, std::int64_t now_us);
  // Somebody came from this machine: a vote against one who left it goes on against the newcomer,
  // whose number it returns; 0: there is none.
  std::uint32_t carry_over(const std::string& machine, std::uint32_t newcomer,
                           const std::function<bool(std::uint32_t)>& here);
  // The target of the next vote whose time is over, forgotten by this call; 0: none.
  std::uint32_t expire(std::int64_t now_us);
  bool any() const { return !open_.empty(); }

  void put_out(const std::string& machine) { out_.insert(machine); }
  bool is_out(const std::string& machine) const { return out_.contains(machine); }
  // The match is over, and with it all votes, which expire() names now, and what they decided.
  void begin_anew() {
    out_.clear();
    for (Vote& vote : open_) vote.until_us = 0;
  }

 private:
  struct Vote {
    std::uint32_t target;
    std::string machine;
    std::int64_t until_us;
    std::vector<std::string> in_favour;
  };
  std::vector<Vote> open_;
  RateLimits begun_{1, kEveryUs};
  std::set<std::string> out_;
};

}  // namespace server
