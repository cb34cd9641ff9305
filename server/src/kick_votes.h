// Votes to remove a player. More than half of the machines of the other players decide, but never
// one alone: a single opponent can ask the host. A removed player gets no rods until a match is
// over; neither does anybody else from the same machine.
//
// Time is an argument. Strings name machines; an owner of many addresses counts as one
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
  static constexpr std::int64_t kEveryUs = 60'000'000;  // between votes of one machine
  static constexpr int kFewest = 2;                     // min number of votes
  // How long a removed player stays out if no match ends: an idle table locks nobody out for good.
  static constexpr std::int64_t kOutUs = 30 * 60'000'000LL;

  struct Target {
    std::uint32_t client = 0;
    std::string name, machine;
  };

  struct Count {
    bool taken = false;  // false: it would begin a vote, but its last one is too recent
    int votes = 0, needed = 0;
    bool passed() const { return taken && votes >= needed; }
  };
  // voters: the machines of all other current players, each once, including the voter's. A vote
  // that passes is closed, and the target is removed. Precondition: voters.size() >= kFewest.
  Count cast(const std::string& voter, const Target& target, std::span<const std::string> voters,
             std::int64_t now_us);
  bool open_against(std::uint32_t client) const;
  void close(std::uint32_t client);  // without a result
  // A client joined from this machine. An open vote against a client that has left that machine
  // continues against the newcomer. Returns the client that left; nothing if there is no such vote.
  using Here = std::function<bool(std::uint32_t)>;
  std::optional<Target> carry_over(const Target& newcomer, const Here& here);
  // The client continues from this machine.
  void moved(std::uint32_t client, const std::string& machine);
  // True if a vote is open against another connected client of this machine.
  bool open_against_another(const std::string& machine, std::uint32_t client,
                            const Here& here) const;
  // Removes the next expired vote and returns its target; 0: none.
  std::uint32_t expire(std::int64_t now_us);
  bool any() const { return !open_.empty(); }

  void put_out(const std::string& machine, std::int64_t now_us);
  // Remaining time for which it may not play unless a match ends before; 0: it may play.
  std::int64_t out_us(const std::string& machine, std::int64_t now_us) const;
  // The match is over. Removed players may play again, and expire() now returns all open votes.
  void begin_anew() {
    out_.clear();
    for (Vote& vote : open_) vote.until_us = 0;
  }

 private:
  struct Vote {
    Target target;
    std::vector<std::string> machines;  // the target's machines while the vote was open
    std::int64_t until_us;
    std::vector<std::string> in_favour;
  };
  std::vector<Vote> open_;
  RateLimits begun_{1, kEveryUs};
  std::map<std::string, std::int64_t> out_;  // end of the exclusion
};

}  // namespace server
