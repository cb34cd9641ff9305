// Votes against a player. More than half of the machines of the others who play decide, and never
// one alone: against an opponent there is the host. Who was put out gets no rods until a match is
// over, nor does anybody else who comes from that machine meanwhile.
//
// Time is an argument; texts name machines, of which an owner of many addresses has one
// (Seat::owner).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
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
  // How long who was put out stays so where no match ends: nobody is locked out of an idle table.
  static constexpr std::int64_t kOutUs = 30 * 60'000'000LL;

  struct Target {
    std::uint32_t client = 0;
    std::string name, machine;
  };

  struct Count {
    bool taken = false;  // false: it would begin a vote, and began one just now
    int votes = 0, needed = 0;
    bool passed() const { return taken && votes >= needed; }
  };
  // voters: the machines of all others who play now, each once, the voter's among them. A vote that
  // passed is over, and the target out. Precondition: voters.size() >= kFewest.
  Count cast(const std::string& voter, const Target& target, std::span<const std::string> voters,
             std::int64_t now_us);
  bool open_against(std::uint32_t client) const;
  void close(std::uint32_t client);  // without a result
  // Somebody came from this machine: a vote against one who left it goes on against the newcomer.
  // Returns who left; nothing where there is no such vote.
  using Here = std::function<bool(std::uint32_t)>;
  std::optional<Target> carry_over(const Target& newcomer, const Here& here);
  // The client goes on from this machine.
  void moved(std::uint32_t client, const std::string& machine);
  // A vote is open against a client of this machine who is here, and is not this one.
  bool open_against_another(const std::string& machine, std::uint32_t client,
                            const Here& here) const;
  // The target of the next vote whose time is over, forgotten by this call; 0: none.
  std::uint32_t expire(std::int64_t now_us);
  bool any() const { return !open_.empty(); }

  void put_out(const std::string& machine, std::int64_t now_us);
  // How long it may not play unless a match ends before; 0: it may.
  std::int64_t out_us(const std::string& machine, std::int64_t now_us) const;
  // The match is over, and with it all votes, which expire() names now, and what they decided.
  void begin_anew() {
    out_.clear();
    for (Vote& vote : open_) vote.until_us = 0;
  }

 private:
  struct Vote {
    Target target;
    std::vector<std::string> machines;  // where the target was while it was open
    std::int64_t until_us;
    std::vector<std::string> in_favour;
  };
  std::vector<Vote> open_;
  RateLimits begun_{1, kEveryUs};
  std::map<std::string, std::int64_t> out_;  // until when
};

}  // namespace server
