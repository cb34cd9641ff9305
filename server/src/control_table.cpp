// The part of ControlServer that assigns seats and checks permissions.
#include <algorithm>
#include <bit>
#include <utility>

#include "control_server.h"
#include "os/clock.h"
#include "os/socket_address.h"
#include "request_rules.h"
#include "socket.h"
#include "wire/limits.h"
#include "wire/snapshot.h"
#include "wire/text.h"

namespace server {
namespace {

using State = ControlConnection::State;
using wire::make_sentence;
using wire::SentenceId;

// Topics of notices: of a reserved seat; of a vote, see wire/limits.h; of a claim.
constexpr std::uint32_t kAwayTopic = 1'000'000;
constexpr std::uint32_t kClaimTopic = 300;
// Client id of a request that was decided by a vote.
constexpr std::uint32_t kEverybody = 0;

std::uint32_t vote_topic(const foosball::Command& request) {
  return wire::vote_topic(static_cast<wire::RequestKind>(request.kind), request.value);
}

wire::Sentence asks_for(const foosball::Command& request, const std::string& name, int votes,
                        int needed) {
  if (request.kind == foosball::Command::Kind::restart)
    return make_sentence<SentenceId::asks_for_restart>(name, votes, needed);
  return request.value != 0 ? make_sentence<SentenceId::asks_for_pause>(name, votes, needed)
                            : make_sentence<SentenceId::asks_to_go_on>(name, votes, needed);
}

}  // namespace

// --- joining

void ControlServer::answer_knock(ControlConnection& connection, const wire::Knock& knock) {
  const auto role = static_cast<wire::Role>(knock.role);
  const auto& password =
      role == wire::Role::host ? options_.access.host_password : options_.access.password;
  if (knock.version != wire::kControlVersion) {
    refuse(connection, wire::Refusal::Code::version,
           make_sentence<SentenceId::other_version>(wire::kControlVersion, knock.version));
    return;
  }
  if (!password) {
    refuse(connection, wire::Refusal::Code::not_allowed,
           role == wire::Role::host ? make_sentence<SentenceId::no_hosts_from_afar>()
                                    : make_sentence<SentenceId::nobody_from_afar>());
    return;
  }
  if (!password_tries_.charge(connection.peer(), os::monotonic_us())) {
    refuse(connection, wire::Refusal::Code::password, make_sentence<SentenceId::wrong_passwords>());
    return;
  }
  connection.try_charged = true;
  const wire::PasswordExchange exchange(wire::PasswordExchange::Side::server, *password,
                                        wire::exchange_channel(role == wire::Role::host),
                                        knock.sid);
  const auto secret = exchange.secret(knock.share);
  if (!secret) return reject(connection, make_sentence<SentenceId::other_password_share>());
  send(connection, wire::Challenge{exchange.share()});
  connection.seal(wire::stream_keys(*secret));
  connection.role = role;
}

void ControlServer::greet(ControlConnection& connection, const wire::Hello& hello) {
  // A client that gave up waiting has tried again since. Its abandoned connection must not take its
  // seat.
  if (connection.peer_left()) {
    count(Count::gave_up);
    release(connection, Going::left);
    return;
  }
  // A readable sealed message proves that the password was right.
  if (std::exchange(connection.try_charged, false)) password_tries_.refund(connection.peer());
  if (!connection.sealed() && trusted(connection)) connection.role = wire::Role::host;
  if (hello.version != wire::kControlVersion) {
    refuse(connection, wire::Refusal::Code::version,
           make_sentence<SentenceId::other_version>(wire::kControlVersion, hello.version));
  } else if (hello.snapshot_layout != wire::snapshot_layout_hash()) {
    refuse(connection, wire::Refusal::Code::layout, make_sentence<SentenceId::other_snapshots>());
  } else if (!connection.sealed() && !connection.vouched() && !trusted(connection)) {
    refuse(connection, wire::Refusal::Code::password, make_sentence<SentenceId::password_wanted>());
  } else if (pending_.size() > kMaxPending) {
    refuse(connection, wire::Refusal::Code::full, make_sentence<SentenceId::server_overloaded>());
  } else if (!resume(connection, hello)) {
    RodSet rods = 0;
    if (admit_to_table(connection, hello, rods)) join(connection, hello, rods);
  }
}

// Returns true if the client has its seat again, or was rejected. An expired ticket counts as none.
bool ControlServer::resume(ControlConnection& connection, const wire::Hello& hello) {
  if (hello.session != options_.session) return false;
  Seat* seat = seats_.find_ticket(hello.ticket);
  if (seat == nullptr) return false;
  if (!seat->resumes.take(os::monotonic_us())) {
    refuse(connection, wire::Refusal::Code::full, make_sentence<SentenceId::server_overloaded>());
    return true;
  }
  // The previous connection may still look open: the cable was unplugged, or the address has
  // changed.
  for (auto& other : connections_) {
    if (other->client != seat->client) continue;
    other->client = 0;
    other->close_softly(0);
  }
  seat->peer = connection.peer();
  seat->owner = owner_of(connection);
  kicks_.moved(seat->client, seat->owner);
  const bool was_away = seat->away();
  if (!welcome(connection, *seat, ControlEvent::Kind::back, hello.udp_port)) {
    if (!was_away) lose_seat(seat->client);  // its old connection is closed: the reservation starts
    return true;
  }
  seat->away_since_us = -1;
  count(Count::resumed);
  if (was_away) {
    clear_notice(kAwayTopic + seat->client, seat->name + " is back");
  }
  log(LogLevel::info, seat->name + " at " + os::to_text(connection.peer()) + " is back");
  return true;
}

// Returns true if there is a free seat, and free rods if it requests some.
bool ControlServer::admit_to_table(ControlConnection& connection, const wire::Hello& hello,
                                   RodSet& rods) {
  const auto& limits = options_.limits;
  if (hello.team != wire::kWatchOnly && !options_.teams_open) {
    refuse(connection, wire::Refusal::Code::team_taken,
           make_sentence<SentenceId::recording_plays_join>());
    return false;
  }
  drain_leavers(hello.rods != 0 ? hello.rods : rods_of_team(options_.layout, hello.team));
  // The roster cannot list more than kMaxSeats.
  const auto max = std::min(static_cast<std::size_t>(limits.connections), wire::kMaxSeats);
  if (seats_.all().size() >= max) {
    refuse(connection, wire::Refusal::Code::full, make_sentence<SentenceId::server_full>());
    return false;
  }
  const auto& peer = connection.peer();
  const bool here = peer.is_loopback();
  if (seats_.of_machine(peer) >= (here ? limits.per_local_address : limits.per_address) ||
      (!here && seats_.of_network(peer) >= limits.per_network)) {
    refuse(connection, wire::Refusal::Code::full,
           make_sentence<SentenceId::too_many_connections>());
    return false;
  }
  if (hello.team == wire::kWatchOnly && hello.rods == 0) return true;
  if (const wire::Sentence why = why_out(owner_of(connection), connection.role, 0); !why.empty()) {
    refuse(connection, wire::Refusal::Code::not_allowed, why);
    return false;
  }
  auto grant = seats_.grant(hello.team, hello.rods, 0, connection.role == wire::Role::host);
  rods = grant.rods;
  switch (grant.kind) {
    case Seats::Grant::Kind::granted:
      return true;
    case Seats::Grant::Kind::taken:
      refuse(connection, wire::Refusal::Code::team_taken, grant.sentence);
      return false;
    case Seats::Grant::Kind::other_team:
      refuse(connection, wire::Refusal::Code::not_allowed, grant.sentence);
      return false;
    case Seats::Grant::Kind::none:
      break;
  }
  reject(connection, grant.sentence);
  return false;
}

std::string ControlServer::owner_of(const ControlConnection& connection) {
  return connection.peer().owner(connection.local_address());
}

// Handles disconnections that are not processed yet, so that these rods become free.
void ControlServer::drain_leavers(RodSet wanted) {
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    ControlConnection& connection = *connections_[i];
    const Seat* seat = seats_.find(connection.client);
    if (seat == nullptr || (seat->rods & wanted) == 0) continue;
    drain(connection);
  }
}

void ControlServer::join(ControlConnection& connection, const wire::Hello& hello, RodSet rods) {
  Seat seat;
  seat.client = ++last_client_;
  seat.ticket = options_.random();
  seat.owner = owner_of(connection);
  seat.wanted_name = wire::clean_name(hello.name);
  seat.name = seats_.name_for(seat, hello.team);
  seat.team = hello.team;
  seat.rods = rods;
  seat.role = connection.role;
  if (rods == 0 && seat.role == wire::Role::player) seat.role = wire::Role::watcher;
  seat.peer = connection.peer();
  const std::uint32_t client = seat.client;
  if (!welcome(connection, seats_.add(seat), ControlEvent::Kind::joined, hello.udp_port)) {
    seats_.remove(client);
    return;
  }
  count(Count::joined);
  carry_vote_over(*seats_.find(client));
  log(LogLevel::info,
      seat.name + " at " + os::to_text(connection.peer()) +
          (rods == 0 ? " watches"
                     : " plays team " + std::to_string(seat.team) + ", rods " + to_text(rods)));
}

wire::SealKey ControlServer::random_key() {
  wire::SealKey key;
  for (std::size_t i = 0; i < key.size(); i += 8) {
    const std::uint64_t bits = options_.random();
    for (std::size_t k = 0; k < 8; ++k) key[i + k] = static_cast<std::byte>(bits >> 8 * k);
  }
  return key;
}

// The socket for its inputs; none for a watcher.
os::FileDescriptor ControlServer::client_socket(const ControlConnection& connection,
                                                const os::SocketAddress& listener) {
  auto local = connection.local_address();
  local.set_port(options_.udp_port);
  auto opened = open_client_socket(options_.udp, local, listener);
  return opened ? std::move(*opened) : os::FileDescriptor();
}

// Passes the client to the tick before it sends the Welcome, so that the next tick knows it.
// Returns false, after a rejection, if that fails.
bool ControlServer::welcome(ControlConnection& connection, Seat& seat, ControlEvent::Kind kind,
                            std::uint16_t udp_port) {
  ControlEvent event;
  event.kind = kind;
  event.client = seat.client;
  event.team = seat.team;
  event.rods = seat.rods;
  event.token = seat.ticket;
  seat.name.copy(event.name.data(), event.name.size() - 1);
  event.input_key = seat.input_key = random_key();
  seat.udp_port = udp_port;
  event.snapshot_key = options_.multicast ? options_.group_key : random_key();
  event.listener = connection.peer();
  event.listener.set_port(udp_port);
  event.local_address = connection.local_address();
  seat.has_socket = seat.plays() && !connection.vouched();
  if (seat.has_socket) {
    event.socket = client_socket(connection, event.listener);
    if (!event.socket) {
      refuse(connection, wire::Refusal::Code::full, make_sentence<SentenceId::no_socket_left>());
      return false;
    }
  }
  wire::Welcome welcome;
  welcome.session = options_.session;
  welcome.token = seat.ticket;
  welcome.udp_port = options_.udp_port;
  welcome.layout = static_cast<std::uint8_t>(options_.layout);
  welcome.team = seat.team;
  welcome.rods = seat.rods;
  welcome.role = number(seat.role);
  welcome.client = seat.client;
  welcome.input_key = event.input_key;
  welcome.snapshot_key = event.snapshot_key;
  if (options_.multicast) {
    welcome.multicast = options_.multicast->address;
    welcome.multicast_port = options_.multicast->port;
  }
  pending_.push_back(std::move(event));
  push_events();
  connection.state = State::joined;
  connection.client = seat.client;
  send(connection, welcome);
  send(connection, options_.characters);
  for (const auto& [topic, notice] : notices_) send(connection, notice);
  if (tuning_) send(connection, *tuning_);
  if (game_) send(connection, *game_);
  if (report_) send(connection, *report_);
  const bool may_play = connection.role != wire::Role::watcher && !connection.vouched();
  if (!options_.phones.empty() && may_play) send(connection, wire::Phones{options_.phones});
  roster_changed_ = true;
  return true;
}

// --- assignment of rods

// A seat that gives up its rods watches, and may have rods of either team again.
void ControlServer::take_claim(ControlConnection& connection, const wire::Claim& claim) {
  Seat* seat = seats_.find(connection.client);
  if (seat == nullptr || !connection.requests.take(os::monotonic_us())) return;
  const auto refuse_it = [&](const wire::Sentence& why_not) {
    answer(connection, kClaimTopic, why_not);
  };
  if (!options_.teams_open) return refuse_it(make_sentence<SentenceId::recording_plays>());
  if (connection.role == wire::Role::watcher)
    return refuse_it(make_sentence<SentenceId::joined_to_watch>());
  const wire::Sentence out = why_out(seat->owner, connection.role, seat->client);
  if (!out.empty() && (claim.rods & ~seat->rods) != 0) return refuse_it(out);
  const std::uint8_t team = claim.team != wire::kWatchOnly ? claim.team : seat->team;
  auto grant = Seats::Grant{Seats::Grant::Kind::granted, 0, {}};
  if (claim.rods != 0)
    grant = seats_.grant(team, claim.rods, seat->client, seat->role == wire::Role::host);
  if (grant.kind != Seats::Grant::Kind::granted) return refuse_it(grant.sentence);
  ControlEvent event;
  event.kind = ControlEvent::Kind::rods;
  if (!seat->has_socket && !connection.vouched() && grant.rods != 0) {
    auto listener = connection.peer();
    listener.set_port(seat->udp_port);
    event.socket = client_socket(connection, listener);
    if (!event.socket) return refuse_it(make_sentence<SentenceId::no_socket_left>());
    seat->has_socket = true;
  }
  const std::uint8_t team_now = grant.rods != 0 ? team : wire::kWatchOnly;
  if (team_now != seat->team) seat->name = seats_.name_for(*seat, team_now);
  seat->rods = grant.rods;
  seat->team = team_now;
  const bool only_watches = grant.rods == 0 && connection.role == wire::Role::player;
  seat->role = only_watches ? wire::Role::watcher : connection.role;
  event.client = seat->client;
  event.team = seat->team;
  event.rods = seat->rods;
  event.token = seat->ticket;
  seat->name.copy(event.name.data(), event.name.size() - 1);
  event.input_key = seat->input_key;
  pending_.push_back(std::move(event));
  push_events();
  roster_changed_ = true;
}

// A client that changes its name during a match counts as another player (docs/rules.md).
void ControlServer::take_names(ControlConnection& connection, const wire::Names& names) {
  Seat* seat = seats_.find(connection.client);
  if (seat == nullptr || pending_.size() > kMaxPending ||
      !connection.requests.take(os::monotonic_us()))
    return;
  if (const std::string wanted = wire::clean_name(names.name); wanted != seat->wanted_name) {
    seat->wanted_name = wanted;
    seat->name.clear();
    seat->name = seats_.name_for(*seat, seat->team);
    report_name(*seat, 0, seat->name);
  }
  wire::RodPlayers players;
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const auto r = static_cast<std::size_t>(rod);
    if (!names.players[r].empty())
      players[r] = seats_.player_name(*seat, wire::clean_name(names.players[r]), rod);
  }
  for (RodSet untold = 0xFF; untold != 0;) {
    const std::string& name = players[static_cast<std::size_t>(std::countr_zero(untold))];
    RodSet same = 0;
    for (std::size_t rod = 0; rod < players.size(); ++rod)
      if (players[rod] == name) same |= RodSet(1u << rod);
    report_name(*seat, same, name);
    untold &= static_cast<RodSet>(~same);
  }
  seat->players = std::move(players);
  push_events();
  roster_changed_ = true;
}

void ControlServer::report_name(const Seat& seat, RodSet rods, const std::string& name) {
  ControlEvent event;
  event.kind = ControlEvent::Kind::name;
  event.client = seat.client;
  event.rods = rods;
  name.copy(event.name.data(), event.name.size() - 1);
  pending_.push_back(std::move(event));
}

void ControlServer::lose_seat(std::uint32_t client) {
  Seat& seat = *seats_.find(client);
  seat.away_since_us = os::monotonic_us();
  count(Count::lost);
  ControlEvent event;
  event.kind = ControlEvent::Kind::away;
  event.client = client;
  pending_.push_back(std::move(event));
  push_events();
  const auto seconds = std::to_string(options_.limits.seat_kept_us / 1'000'000);
  publish(wire::Notice::Level::warning, kAwayTopic + client,
          make_sentence<SentenceId::player_lost>(seat.name, to_text(seat.rods), seconds));
  log(LogLevel::warning, seat.name + " at " + os::to_text(seat.peer) +
                             " was lost: its rods are reserved for " + seconds + " s");
  roster_changed_ = true;
}

void ControlServer::give_up_seat(std::uint32_t client) {
  const Seat* seat = seats_.find(client);
  if (seat == nullptr) return;
  if (seat->away()) {
    clear_notice(kAwayTopic + client, seat->name + " has left");
  }
  log(LogLevel::info, seat->name + " at " + os::to_text(seat->peer) + " left");
  ControlEvent event;
  event.kind = ControlEvent::Kind::left;
  event.client = client;
  event.put_out = seat->put_out;
  seats_.remove(client);
  count(Count::left);
  pending_.push_back(std::move(event));
  push_events();
  roster_changed_ = true;
}

void ControlServer::watch_seats() {
  const std::int64_t now = os::monotonic_us();
  for (bool again = true; again;) {
    const auto over = std::ranges::find_if(seats_.all(), [&](const Seat& s) {
      return s.away() && now - s.away_since_us >= options_.limits.seat_kept_us;
    });
    again = over != seats_.all().end();
    if (again) give_up_seat(over->client);
  }
  foosball::Command request{};
  while (votes_.expire(now, request)) {
    clear_notice(vote_topic(request), "there were too few votes");
  }
}

void ControlServer::send_roster() {
  roster_changed_ = false;
  const wire::Roster roster = seats_.roster();
  for (auto& connection : connections_) {
    if (connection->state == State::joined) send(*connection, roster);
  }
}

// --- requests

void ControlServer::take_request(ControlConnection& connection, const wire::MatchRequest& asked) {
  if (!well_formed(asked)) {
    reject(connection, make_sentence<SentenceId::no_such_request>());
    return;
  }
  const Seat* seat = seats_.find(connection.client);
  const foosball::Command command = command_of(asked);
  // Several people at one client may play rods of both teams.
  const bool plays_it =
      seat != nullptr && (seat->rods & rods_of_team(options_.layout, command.team)) != 0;
  const Ruling ruling = seat != nullptr
                            ? rule(seat->role, plays_it ? command.team : seat->team, command)
                            : Ruling::no;
  const bool keeps_tuning = command.kind == foosball::Command::Kind::tune && in_challenge();
  if (ruling == Ruling::yes && keeps_tuning)
    answer(connection, wire::kGameAnswerTopic, make_sentence<SentenceId::challenge_keeps_tuning>());
  const bool taken =
      !keeps_tuning && ruling != Ruling::no && connection.requests.take(os::monotonic_us()) &&
      (ruling == Ruling::yes ? hand_on(seat->client, command) : put_to_vote(*seat, command));
  count(taken ? Count::requests : Count::requests_dropped);
}

// --- the questionnaire

// Asks connected clients with rods; the players of a cabinet have no client of their own.
void ControlServer::publish_questionnaires() {
  wire::Questionnaire won;
  while (questionnaires_.pop(won)) {
    RodSet cabinet = won.rods;
    for (auto& connection : connections_) {
      Seat* seat = seats_.find(connection->client);
      if (seat == nullptr || connection->state != State::joined) continue;
      RodSet rods = seat->rods & ~won.rods;
      if (seat->role == wire::Role::host && seat->peer.is_loopback())
        rods |= std::exchange(cabinet, RodSet{0});
      seat->asked_match = won.match;
      seat->asked_rods = rods;
      if (rods != 0) send(*connection, wire::Questionnaire{won.match, rods});
    }
  }
}

// Each rod that was asked answers once: nobody can answer for others, or twice.
void ControlServer::take_answers(ControlConnection& connection, const wire::Answers& answers) {
  Seat* seat = seats_.find(connection.client);
  if (seat == nullptr || !connection.requests.take(os::monotonic_us())) {
    count(Count::answers_refused);
    return;
  }
  const auto refuse_them = [&](const wire::Sentence& why) {
    count(Count::answers_refused);
    answer(connection, wire::kAnswersTopic, why);
  };
  if (answers.match == 0 || answers.match != seat->asked_match)
    return refuse_them(make_sentence<SentenceId::answers_of_other_match>());
  if ((answers.rods & ~seat->asked_rods) != 0)
    return refuse_them(make_sentence<SentenceId::answers_given_already>());
  std::uint8_t team = 0;
  while (team < foosball::kTeams && (answers.rods & ~rods_of_team(options_.layout, team)) != 0)
    ++team;
  if (team == foosball::kTeams)
    return refuse_them(make_sentence<SentenceId::answers_of_both_teams>());
  if (std::ranges::all_of(answers.scores, [](std::uint8_t score) { return score == 0; }))
    return refuse_them(make_sentence<SentenceId::answers_empty>());
  if (pending_.size() > kMaxPending)
    return refuse_them(make_sentence<SentenceId::server_overloaded>());
  seat->asked_rods &= static_cast<RodSet>(~answers.rods);
  count(Count::answers);
  ControlEvent event;
  event.kind = ControlEvent::Kind::answers;
  event.client = seat->client;
  event.team = team;
  event.answers = answers;
  pending_.push_back(std::move(event));
  push_events();
}

bool ControlServer::hand_on(std::uint32_t client, const foosball::Command& command) {
  if (pending_.size() > kMaxPending) return false;
  ControlEvent event;
  event.kind = ControlEvent::Kind::request;
  event.client = client;
  event.request = command;
  pending_.push_back(std::move(event));
  push_events();
  return true;
}

// One vote per machine, for any number of seats: more connections are not more people. Disconnected
// players do not vote and are not waited for, except on a restart, which would end a match without
// a result.
bool ControlServer::put_to_vote(const Seat& seat, const foosball::Command& command) {
  std::vector<std::string> voters;
  for (const Seat& s : seats_.all()) {
    const bool counts = !s.away() || command.kind == foosball::Command::Kind::restart;
    if ((s.plays() || s.role == wire::Role::host) && counts) voters.push_back(s.owner);
  }
  std::ranges::sort(voters);
  voters.erase(std::unique(voters.begin(), voters.end()), voters.end());
  const auto votes = votes_.cast(seat.owner, command, voters, os::monotonic_us());
  if (votes.passed()) {
    clear_notice(vote_topic(command), "agreed");
    return hand_on(kEverybody, command);
  }
  publish(wire::Notice::Level::info, vote_topic(command),
          asks_for(command, seat.name, votes.votes, votes.needed));
  return true;
}

}  // namespace server
