// Votes on requests that concern both teams: they need more than half of the machines that play.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "foosball/match.h"

namespace server {

class Votes {
 public:
  static constexpr std::int64_t kOpenUs = 20'000'000;  // from the first vote on

  struct Count {
    int votes = 0, needed = 0;
    bool passed() const { return votes >= needed; }
  };
  // voters: all who may vote now, each once, including the voter. A vote that passes is closed.
  Count cast(const std::string& voter, const foosball::Command& request,
             std::span<const std::string> voters, std::int64_t now_us);
  // Removes the next expired vote. False: none.
  bool expire(std::int64_t now_us, foosball::Command& request);
  bool any() const { return !open_.empty(); }

 private:
  struct Vote {
    foosball::Command request;
    std::int64_t until_us;
    std::vector<std::string> in_favour;
  };
  std::vector<Vote> open_;
};

}  // namespace server
