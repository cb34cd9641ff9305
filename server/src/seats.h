// Seats at the table and their rods. Several clients may share a team, each with its own rods. A
// lost player's seat is reserved for a while; the player resumes it with its ticket.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "door.h"
#include "foosball/table.h"
#include "os/socket_address.h"
#include "wire/control.h"
#include "wire/enums.h"
#include "wire/seal.h"
#include "wire/sentence.h"

namespace server {

// Bit mask of rods; bit 0 is the rod at -x.
using RodSet = std::uint8_t;
static_assert(foosball::kRods == 8);
RodSet rods_of_team(foosball::Layout layout, std::uint8_t team);  // none for wire::kWatchOnly
std::string to_text(RodSet rods);                                 // "1, 2 and 4", counted from 1

struct Seat {
  // Limits changes that all clients see: two clients with one ticket take the seat from each other
  // in turn.
  static constexpr int kResumesAtOnce = 8;
  static constexpr std::int64_t kResumeEveryUs = 1'000'000;

  std::uint32_t client = 0;  // increases, never reused
  std::uint64_t ticket = 0;  // the client's secret
  std::string wanted_name;   // as requested: wire::clean_name()
  std::string name;          // Seats::name_for()
  wire::RodPlayers players;  // Seats::player_name(); also for rods that it does not have
  std::uint8_t team = wire::kWatchOnly;
  RodSet rods = 0;
  wire::Role role = wire::Role::watcher;
  os::SocketAddress peer;
  std::string owner;              // os::SocketAddress::owner() of peer
  std::uint16_t udp_port = 0;     // where it receives snapshots
  wire::SealKey input_key{};      // of its inputs
  bool has_socket = false;        // the tick has one for its inputs
  std::uint32_t asked_match = 0;  // of the questionnaire; 0: not asked yet
  RodSet asked_rods = 0;          // whose players have not answered
  bool put_out = false;           // removed by others
  RateLimit resumes{kResumesAtOnce, kResumeEveryUs};
  std::int64_t away_since_us = -1;  // >= 0: when it was lost; negative: connected

  bool away() const { return away_since_us >= 0; }
  bool plays() const { return rods != 0; }
};

class Seats {
 public:
  // mixed_teams: remote clients, too, may have rods of both teams.
  Seats(foosball::Layout layout, bool mixed_teams) : layout_(layout), mixed_teams_(mixed_teams) {}

  const std::vector<Seat>& all() const { return seats_; }
  Seat* find(std::uint32_t client);
  const Seat* find(std::uint32_t client) const;
  Seat* find_ticket(std::uint64_t ticket);
  Seat& add(Seat seat) { return seats_.emplace_back(std::move(seat)); }
  void remove(std::uint32_t client);
  int of_machine(const os::SocketAddress& peer) const;
  // The name of this seat, or of a new one, in this team: its current name, otherwise the requested
  // one. A number is appended if another client here has that name, of another owner or of another
  // team, or if the results use it for something other than a named person (computer, cabinet,
  // nobody). Results and ratings use names as keys, so that a name changes only when necessary.
  std::string name_for(const Seat& seat, std::uint8_t team) const;
  // The same for one of several people at this seat, who plays this rod; empty: the seat's own
  // name.
  std::string player_name(const Seat& seat, const std::string& wanted, int rod) const;
  int of_network(const os::SocketAddress& peer) const;

  struct Grant {
    enum class Kind : std::uint8_t { granted, taken, other_team, none };
    Kind kind = Kind::none;
    RodSet rods = 0;          // granted
    wire::Sentence sentence;  // otherwise the reason, and what to do
  };
  // The rods that a client of this team may have of those requested; 0: all free rods of the team.
  // client: its own rods count as free; 0: none. trusted: on this machine, or the host.
  Grant grant(std::uint8_t team, RodSet wanted, std::uint32_t client, bool trusted) const;

  wire::Roster roster() const;

 private:
  bool is_free(const std::string& name, const Seat& seat, std::uint8_t team) const;
  std::string free_name(const std::string& wanted, const Seat& seat, std::uint8_t team) const;
  RodSet taken_from(std::uint32_t client) const;

  foosball::Layout layout_;
  bool mixed_teams_;
  std::vector<Seat> seats_;
};

}  // namespace server
