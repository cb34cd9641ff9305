#include "seats.h"

#include <algorithm>
#include <utility>

namespace server {

using wire::make_sentence;
using wire::SentenceId;

RodSet rods_of_team(foosball::Layout layout, std::uint8_t team) {
  RodSet rods = 0;
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if (foosball::table_spec(layout).rods[rod].team == team) rods |= RodSet(1u << rod);
  }
  return rods;
}

std::string to_text(RodSet rods) {
  std::vector<std::string> names;
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if (rods >> rod & 1) names.push_back(std::to_string(rod + 1));
  }
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

const Seat* Seats::find(std::uint32_t client) const {
  const auto it = std::ranges::find(seats_, client, &Seat::client);
  return client != 0 && it != seats_.end() ? &*it : nullptr;
}

Seat* Seats::find(std::uint32_t client) {
  return const_cast<Seat*>(std::as_const(*this).find(client));
}

Seat* Seats::find_ticket(std::uint64_t ticket) {
  const auto it = std::ranges::find(seats_, ticket, &Seat::ticket);
  return ticket != 0 && it != seats_.end() ? &*it : nullptr;
}

void Seats::remove(std::uint32_t client) {
  std::erase_if(seats_, [client](const Seat& s) { return s.client == client; });
}

int Seats::of_machine(const os::SocketAddress& peer) const {
  return static_cast<int>(std::ranges::count_if(
      seats_, [key = peer.machine()](const Seat& s) { return s.peer.machine() == key; }));
}

namespace {

// Names that the results use for players who are not named persons: "computer 5", "cabinet",
// "nobody".
bool is_name_of_results(std::string_view name) {
  return name == "cabinet" || name == "nobody" || name == "computer" ||
         name.starts_with("computer ");
}

bool has_name(const Seat& seat, const std::string& name) {
  return seat.name == name || std::ranges::count(seat.players, name) > 0;
}

}  // namespace

bool Seats::is_free(const std::string& name, const Seat& seat, std::uint8_t team) const {
  return std::ranges::none_of(seats_, [&](const Seat& s) {
    return s.client != seat.client && has_name(s, name) &&
           (s.owner != seat.owner || s.team != team);
  });
}

std::string Seats::name_for(const Seat& seat, std::uint8_t team) const {
  if (!seat.name.empty() && is_free(seat.name, seat, team)) return seat.name;
  return free_name(seat.wanted_name, seat, team);
}

std::string Seats::player_name(const Seat& seat, const std::string& wanted, int rod) const {
  if (wanted.empty() || wanted == seat.wanted_name) return {};
  const auto team = static_cast<std::uint8_t>(foosball::table_spec(layout_).rods[rod].team);
  return free_name(wanted, seat, team);
}

std::string Seats::free_name(const std::string& wanted, const Seat& seat, std::uint8_t team) const {
  const bool reserved = is_name_of_results(wanted);
  if (!reserved && is_free(wanted, seat, team)) return wanted;
  for (int number = reserved ? 1 : 2;; ++number) {
    const std::string tail = " (" + std::to_string(number) + ")";
    std::string name = wanted.substr(0, wire::kMaxName - tail.size());
    // Does not split a UTF-8 character: its bytes after the first are 10xxxxxx.
    while (name.size() < wanted.size() && !name.empty() &&
           (static_cast<unsigned char>(wanted[name.size()]) & 0xC0u) == 0x80u) {
      name.pop_back();
    }
    if (is_free(name + tail, seat, team)) return name + tail;
  }
}

int Seats::of_network(const os::SocketAddress& peer) const {
  return static_cast<int>(std::ranges::count_if(
      seats_, [key = peer.network()](const Seat& s) { return s.peer.network() == key; }));
}

RodSet Seats::taken_from(std::uint32_t client) const {
  RodSet taken = 0;
  for (const Seat& seat : seats_) {
    if (seat.client != client) taken |= seat.rods;
  }
  return taken;
}

Seats::Grant Seats::grant(std::uint8_t team, RodSet wanted, std::uint32_t client,
                          bool trusted) const {
  const RodSet own = rods_of_team(layout_, team);
  if (own == 0) return {Grant::Kind::none, 0, make_sentence<SentenceId::which_team>()};
  const RodSet taken = taken_from(client), left = RodSet(own & ~taken);
  if (wanted == 0) {
    if (left != 0) return {Grant::Kind::granted, left, {}};
    return {Grant::Kind::taken, 0, make_sentence<SentenceId::team_taken>(team)};
  }
  if ((wanted & ~own) != 0 && !trusted && !mixed_teams_)
    return {Grant::Kind::other_team, 0, make_sentence<SentenceId::rods_of_both_teams>(team)};
  if ((wanted & taken) != 0) {
    const std::string theirs = to_text(RodSet(wanted & taken));
    return {Grant::Kind::taken, 0,
            left != 0 ? make_sentence<SentenceId::rods_taken>(theirs, team, to_text(left))
                      : make_sentence<SentenceId::rods_and_team_taken>(theirs, team)};
  }
  return {Grant::Kind::granted, wanted, {}};
}

wire::Roster Seats::roster() const {
  wire::Roster roster;
  for (const Seat& s : seats_) {
    roster.seats.push_back({s.client, s.name, s.team, s.rods, number(s.role), s.away()});
    for (std::size_t rod = 0; rod < roster.players.size(); ++rod)
      if ((s.rods >> rod & 1) != 0) roster.players[rod] = s.players[rod];
  }
  return roster;
}

}  // namespace server
