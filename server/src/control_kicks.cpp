// The part of ControlServer that removes players: by vote, or by the host.
#include <algorithm>
#include <utility>

#include "control_server.h"
#include "os/clock.h"
#include "os/socket_address.h"
#include "wire/limits.h"

namespace server {
namespace {

using State = ControlConnection::State;
using wire::make_sentence;
using wire::SentenceId;

std::int64_t minutes(std::int64_t us) {
  constexpr std::int64_t kMinuteUs = 60'000'000;
  return (us + kMinuteUs - 1) / kMinuteUs;
}

}  // namespace

// The reason why this seat may not remove the other one; empty: it may, or may vote for it. Giving
// up the rods during a vote does not end the vote.
wire::Sentence ControlServer::why_not_kick(const Seat& voter, const Seat* target) const {
  const bool host = voter.role == wire::Role::host;
  if (!options_.teams_open) return make_sentence<SentenceId::recording_plays>();
  if (!host && !voter.plays()) return make_sentence<SentenceId::watchers_have_no_vote>();
  if (target == nullptr) return make_sentence<SentenceId::target_has_left>();
  if (target->client == voter.client) return make_sentence<SentenceId::target_is_you>();
  if (!target->plays() && !kicks_.open_against(target->client))
    return make_sentence<SentenceId::target_watches>();
  if (target->role == wire::Role::host) return make_sentence<SentenceId::target_is_host>();
  if (!host && target->owner == voter.owner)
    return make_sentence<SentenceId::target_at_your_address>();
  return {};
}

// One vote per machine, as for a pause.
void ControlServer::take_kick(ControlConnection& connection, const wire::Kick& kick) {
  const Seat* voter = seats_.find(connection.client);
  if (voter == nullptr || !connection.requests.take(os::monotonic_us())) return;
  Seat* target = seats_.find(kick.client);
  const auto refuse_it = [&](const wire::Sentence& why) {
    answer(connection, wire::kKickAnswerTopic, why);
  };
  const wire::Sentence why = why_not_kick(*voter, target);
  if (!why.empty()) return refuse_it(why);
  if (voter->role == wire::Role::host) return put_out(*target, true);
  std::vector<std::string> voters;
  for (const Seat& s : seats_.all()) {
    if (s.plays() && !s.away() && s.owner != target->owner) voters.push_back(s.owner);
  }
  std::ranges::sort(voters);
  voters.erase(std::unique(voters.begin(), voters.end()), voters.end());
  if (voters.size() < KickVotes::kFewest) return refuse_it(make_sentence<SentenceId::one_alone>());
  const auto count = kicks_.cast(voter->owner, {target->client, target->name, target->owner},
                                 voters, os::monotonic_us());
  if (!count.taken) return refuse_it(make_sentence<SentenceId::vote_just_begun>());
  if (count.passed()) return put_out(*target, false);
  const std::string votes =
      std::to_string(count.votes) + " of " + std::to_string(count.needed) + " votes";
  log(LogLevel::info, voter->name + " votes to put " + target->name + " out: " + votes);
  publish(wire::Notice::Level::info, wire::kKickTopics + target->client,
          make_sentence<SentenceId::would_put_out>(voter->name, target->name, count.votes,
                                                   count.needed));
}

// Frees the seat and invalidates its ticket. The machine gets no rods until a match is over.
void ControlServer::put_out(Seat& seat, bool by_host) {
  const std::uint32_t client = seat.client;
  seat.put_out = true;
  count(Count::kicked);
  kicks_.put_out(seat.owner, os::monotonic_us());
  kicks_.close(client);
  log(LogLevel::warning, seat.name + " at " + os::to_text(seat.peer) + " is removed by " +
                             (by_host ? "the host" : "the players"));
  clear_notice(wire::kKickTopics + client, seat.name + " is removed");
  const auto connection = std::ranges::find_if(connections_, [&](const auto& c) {
    return c->client == client && c->state == State::joined;
  });
  if (connection == connections_.end()) return give_up_seat(client);
  refuse(**connection, wire::Refusal::Code::not_allowed,
         by_host ? make_sentence<SentenceId::put_out_by_host>(minutes(KickVotes::kOutUs))
                 : make_sentence<SentenceId::put_out_by_players>(minutes(KickVotes::kOutUs)));
}

// The reason why this owner's client (0: not joined yet) may not have rods; empty: it may.
wire::Sentence ControlServer::why_out(const std::string& owner, wire::Role role,
                                      std::uint32_t client) const {
  if (role == wire::Role::host) return {};
  const std::int64_t out_us = kicks_.out_us(owner, os::monotonic_us());
  if (out_us > 0) return make_sentence<SentenceId::address_put_out>(minutes(out_us));
  if (kicks_.open_against_another(owner, client, here()))
    return make_sentence<SentenceId::vote_at_your_address>();
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
    clear_notice(wire::kKickTopics + target, "there were too few votes");
}

// A vote follows a target that leaves and rejoins, to watch or to play. It also continues against
// anyone else who joins from that address meanwhile.
void ControlServer::carry_vote_over(const Seat& newcomer) {
  const auto before = kicks_.carry_over({newcomer.client, newcomer.name, newcomer.owner}, here());
  if (!before) return;
  clear_notice(wire::kKickTopics + before->client, "the vote continues");
  publish(wire::Notice::Level::info, wire::kKickTopics + newcomer.client,
          make_sentence<SentenceId::vote_goes_on>(newcomer.name, before->name, newcomer.name));
}

}  // namespace server
