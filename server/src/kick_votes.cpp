#include "kick_votes.h"

#include <algorithm>

namespace server {

// That a vote failed protects nobody from the next: a friend would begin votes that are to fail.
KickVotes::Count KickVotes::cast(const std::string& voter, std::uint32_t target,
                                 const std::string& target_machine,
                                 std::span<const std::string> voters, std::int64_t now_us) {
  auto vote = std::ranges::find(open_, target, &Vote::target);
  if (vote == open_.end()) {
    if (!begun_.may_take(voter, now_us)) return {};
    begun_.take(voter, now_us);
    vote = open_.insert(vote, {target, target_machine, now_us + kOpenUs, {}});
  }
  if (std::ranges::find(vote->in_favour, voter) == vote->in_favour.end())
    vote->in_favour.push_back(voter);
  // Of those who have left since, no vote counts.
  const auto here = [&](const std::string& who) {
    return std::ranges::find(voters, who) != voters.end();
  };
  const Count count{true, static_cast<int>(std::ranges::count_if(vote->in_favour, here)),
                    std::max(kFewest, static_cast<int>(voters.size()) / 2 + 1)};
  if (count.passed()) open_.erase(vote);
  return count;
}

std::uint32_t KickVotes::carry_over(const std::string& machine, std::uint32_t newcomer,
                                    const std::function<bool(std::uint32_t)>& here) {
  const auto vote = std::ranges::find_if(
      open_, [&](const Vote& v) { return v.machine == machine && !here(v.target); });
  if (vote == open_.end()) return 0;
  const std::uint32_t before = vote->target;
  vote->target = newcomer;
  return before;
}

std::uint32_t KickVotes::expire(std::int64_t now_us) {
  const auto over =
      std::ranges::find_if(open_, [&](const Vote& v) { return now_us >= v.until_us; });
  if (over == open_.end()) return 0;
  const std::uint32_t target = over->target;
  open_.erase(over);
  return target;
}

}  // namespace server
