#include "kick_votes.h"

#include <algorithm>
#include <utility>

namespace server {

// A failed vote does not protect its target: otherwise a friend could begin votes that fail.
KickVotes::Count KickVotes::cast(const std::string& voter, const Target& target,
                                 std::span<const std::string> voters, std::int64_t now_us) {
  auto vote =
      std::ranges::find(open_, target.client, [](const Vote& v) { return v.target.client; });
  if (vote == open_.end()) {
    if (!begun_.may_take(voter, now_us)) return {};
    begun_.take(voter, now_us);
    vote = open_.insert(vote, {target, {target.machine}, now_us + kOpenUs, {}});
  }
  if (std::ranges::find(vote->in_favour, voter) == vote->in_favour.end())
    vote->in_favour.push_back(voter);
  // Votes of players who have left do not count.
  const auto here = [&](const std::string& who) {
    return std::ranges::find(voters, who) != voters.end();
  };
  const Count count{true, static_cast<int>(std::ranges::count_if(vote->in_favour, here)),
                    std::max(kFewest, static_cast<int>(voters.size()) / 2 + 1)};
  if (count.passed()) {
    for (const std::string& machine : vote->machines) put_out(machine, now_us);
    open_.erase(vote);
  }
  return count;
}

bool KickVotes::open_against(std::uint32_t client) const {
  return std::ranges::any_of(open_, [&](const Vote& v) { return v.target.client == client; });
}

void KickVotes::close(std::uint32_t client) {
  std::erase_if(open_, [&](const Vote& v) { return v.target.client == client; });
}

std::optional<KickVotes::Target> KickVotes::carry_over(const Target& newcomer, const Here& here) {
  const auto vote = std::ranges::find_if(open_, [&](const Vote& v) {
    return std::ranges::find(v.machines, newcomer.machine) != v.machines.end() &&
           !here(v.target.client);
  });
  if (vote == open_.end()) return std::nullopt;
  return std::exchange(vote->target, newcomer);
}

void KickVotes::moved(std::uint32_t client, const std::string& machine) {
  for (Vote& vote : open_) {
    if (vote.target.client != client) continue;
    if (std::ranges::find(vote.machines, machine) == vote.machines.end())
      vote.machines.push_back(machine);
  }
}

bool KickVotes::open_against_another(const std::string& machine, std::uint32_t client,
                                     const Here& here) const {
  return std::ranges::any_of(open_, [&](const Vote& v) {
    return v.target.client != client && here(v.target.client) &&
           std::ranges::find(v.machines, machine) != v.machines.end();
  });
}

void KickVotes::put_out(const std::string& machine, std::int64_t now_us) {
  std::erase_if(out_, [&](const auto& entry) { return entry.second <= now_us; });
  out_[machine] = now_us + kOutUs;
}

std::int64_t KickVotes::out_us(const std::string& machine, std::int64_t now_us) const {
  const auto until = out_.find(machine);
  return until == out_.end() ? 0 : std::max<std::int64_t>(0, until->second - now_us);
}

std::uint32_t KickVotes::expire(std::int64_t now_us) {
  const auto over =
      std::ranges::find_if(open_, [&](const Vote& v) { return now_us >= v.until_us; });
  if (over == open_.end()) return 0;
  const std::uint32_t target = over->target.client;
  open_.erase(over);
  return target;
}

}  // namespace server
