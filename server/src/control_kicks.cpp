// The part of ControlServer that puts players out: by vote, or by the host's word.
#include <algorithm>
#include <utility>

#include "control_server.h"
#include "os/clock.h"
#include "os/socket_address.h"
#include "wire/limits.h"

namespace server {
namespace {

using State = ControlConnection::State;

std::string minutes(std::int64_t us) {
  constexpr std::int64_t kMinuteUs = 60'000'000;
  return std::to_string((us + kMinuteUs - 1) / kMinuteUs);
}

}  // namespace

// Why this seat may not put that one out; empty: it may, or may vote for it. Who gives up the rods
// while a vote is open does not escape it.
std::string ControlServer::why_not_kick(const Seat& voter, const Seat* target) const {
  const bool host = voter.role == wire::Role::host;
  if (!options_.teams_open) return "a recording plays here";
  if (!host && !voter.plays()) return "watchers have no vote";
  if (target == nullptr) return "who you would put out has left";
  if (target->client == voter.client) return "you cannot put yourself out: give up your rods";
  if (!target->plays() && !kicks_.open_against(target->client))
    return "only players are put out, and this one watches";
  if (target->role == wire::Role::host) return "the host cannot be put out";
  if (!host && target->owner() == voter.owner())
    return "your address has no vote on its own players";
  return {};
}

// One machine, one vote, as for a pause.
void ControlServer::take_kick(ControlConnection& connection, const wire::Kick& kick) {
  const Seat* voter = seats_.find(connection.client);
  if (voter == nullptr || !connection.wishes.take(os::monotonic_us())) return;
  const Seat* target = seats_.find(kick.client);
  const auto answer = [&](const std::string& text) {
    send(connection, wire::Notice{wire::Notice::Level::info, wire::kKickAnswerTopic, text});
  };
  if (const std::string why = why_not_kick(*voter, target); !why.empty()) return answer(why);
  if (voter->role == wire::Role::host) return put_out(*target, "the host");
  std::vector<std::string> voters;
  for (const Seat& s : seats_.all()) {
    if (s.plays() && !s.away() && s.owner() != target->owner()) voters.push_back(s.owner());
  }
  std::ranges::sort(voters);
  voters.erase(std::unique(voters.begin(), voters.end()), voters.end());
  if (voters.size() < KickVotes::kFewest)
    return answer("one player alone puts nobody out: ask the host");
  const auto count = kicks_.cast(voter->owner(), {target->client, target->name, target->owner()},
                                 voters, os::monotonic_us());
  if (!count.taken) return answer("you began a vote a moment ago: wait a minute");
  if (count.passed()) return put_out(*target, "the players");
  const std::string votes =
      std::to_string(count.votes) + " of " + std::to_string(count.needed) + " votes";
  say(LogLevel::info, voter->name + " votes to put " + target->name + " out: " + votes);
  tell({wire::Notice::Level::info, wire::kKickTopics + target->client,
        voter->name + " would put " + target->name + " out of the match: " + votes});
}

// The seat is free, its ticket worth nothing, and the machine has no rods until a match is over.
void ControlServer::put_out(const Seat& seat, const std::string& by) {
  const std::uint32_t client = seat.client;
  count(Count::kicked);
  kicks_.put_out(seat.owner(), os::monotonic_us());
  kicks_.close(client);
  say(LogLevel::warning, seat.name + " at " + os::to_text(seat.peer) + " is put out by " + by);
  tell({wire::Notice::Level::cleared, wire::kKickTopics + client, seat.name + " is put out"});
  const auto connection = std::ranges::find_if(connections_, [&](const auto& c) {
    return c->client == client && c->state == State::joined;
  });
  if (connection == connections_.end()) return give_up_seat(client);
  refuse(**connection, wire::Refusal::Code::not_allowed,
         by + " put you out: join to watch. You may play when a match has ended, or in " +
             minutes(KickVotes::kOutUs) + " minutes");
}

// Empty: who comes from there, and is this client (0: none yet), may have rods.
std::string ControlServer::why_out(const os::SocketAddress& peer, wire::Role role,
                                   std::uint32_t client) const {
  if (role == wire::Role::host) return {};
  const std::int64_t out_us = kicks_.out_us(peer.network(), os::monotonic_us());
  if (out_us > 0)
    return "somebody at your address was put out: join to watch. You may play when a match has "
           "ended, or in " +
           minutes(out_us) + " minutes";
  if (kicks_.open_against_another(peer.network(), client, here()))
    return "a vote against a player at your address is open: wait for its end";
  return {};
}

KickVotes::Here ControlServer::here() const {
  return [this](std::uint32_t client) { return seats_.find(client) != nullptr; };
}

void ControlServer::match_is_over() {
  matches_over_.fetch_add(1, std::memory_order_release);
}

void ControlServer::watch_kicks(std::int64_t now_us) {
  const std::uint32_t over = matches_over_.load(std::memory_order_acquire);
  if (std::exchange(matches_over_seen_, over) != over) kicks_.begin_anew();
  while (const std::uint32_t target = kicks_.expire(now_us))
    tell({wire::Notice::Level::cleared, wire::kKickTopics + target, "too few wanted it"});
}

// Who leaves and joins anew, to watch or to play, is the one that the vote is about; so is whoever
// else comes from that address meanwhile.
void ControlServer::carry_vote_over(const Seat& newcomer) {
  const auto before = kicks_.carry_over({newcomer.client, newcomer.name, newcomer.owner()}, here());
  if (!before) return;
  tell({wire::Notice::Level::cleared, wire::kKickTopics + before->client, "the vote goes on"});
  tell({wire::Notice::Level::info, wire::kKickTopics + newcomer.client,
        newcomer.name + " comes from the address of " + before->name +
            ", who has left: the vote to put that player out goes on against " + newcomer.name});
}

}  // namespace server
