#include "votes.h"

#include <algorithm>

namespace server {
namespace {

// Votes agree on kind and value, whoever asks and for either team.
bool same_question(const foosball::Command& a, const foosball::Command& b) {
  return a.kind == b.kind && a.value == b.value;
}

}  // namespace

Votes::Count Votes::cast(const std::string& voter, const foosball::Command& request,
                         std::span<const std::string> voters, std::int64_t now_us) {
  auto vote =
      std::ranges::find_if(open_, [&](const Vote& v) { return same_question(v.request, request); });
  if (vote == open_.end()) vote = open_.insert(vote, {request, now_us + kOpenUs, {}});
  if (std::ranges::find(vote->in_favour, voter) == vote->in_favour.end()) {
    vote->in_favour.push_back(voter);
  }
  // Votes of players who have left do not count.
  const auto here = [&](const std::string& who) {
    return std::ranges::find(voters, who) != voters.end();
  };
  const Count count{static_cast<int>(std::ranges::count_if(vote->in_favour, here)),
                    static_cast<int>(voters.size()) / 2 + 1};
  if (count.passed()) open_.erase(vote);
  return count;
}

bool Votes::expire(std::int64_t now_us, foosball::Command& request) {
  const auto over =
      std::ranges::find_if(open_, [&](const Vote& v) { return now_us >= v.until_us; });
  if (over == open_.end()) return false;
  request = over->request;
  open_.erase(over);
  return true;
}

}  // namespace server
