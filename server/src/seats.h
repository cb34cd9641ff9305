// Who has a place at the table, and which rods. Several clients may share a team, each with rods of
// its own. A player who was lost keeps the seat for a while and takes it again with its ticket.
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

// Rods by bit, bit 0 the one at -x.
using RodSet = std::uint8_t;
static_assert(foosball::kRods == 8);
RodSet rods_of_team(foosball::Layout layout, std::uint8_t team);  // none of wire::kWatchOnly
std::string to_text(RodSet rods);                                 // "1, 2 and 4", counted from 1

struct Seat {
  // Each is news to all: of two clients with one ticket each takes the seat from the other.
  static constexpr int kResumesAtOnce = 8;
  static constexpr std::int64_t kResumeEveryUs = 1'000'000;

  std::uint32_t client = 0;  // counts up, never used twice
  std::uint64_t ticket = 0;  // the client's secret
  std::string wanted_name;   // the one that was asked for: wire::clean_name()
  std::string name;          // Seats::name_for()
  wire::RodPlayers players;  // Seats::player_name(); of rods that it has not, too
  std::uint8_t team = wire::kWatchOnly;
  RodSet rods = 0;
  wire::Role role = wire::Role::watcher;
  os::SocketAddress peer;
  std::string owner;              // os::SocketAddress::owner() of peer
  std::uint16_t udp_port = 0;     // where it listens for snapshots
  wire::SealKey input_key{};      // of its inputs
  bool has_socket = false;        // the tick has one for its inputs
  std::uint32_t asked_match = 0;  // the questionnaire's; 0: not asked yet
  RodSet asked_rods = 0;          // whose players have not answered it
  bool put_out = false;           // by others
  RateLimit resumes{kResumesAtOnce, kResumeEveryUs};
  std::int64_t away_since_us = -1;  // not negative: lost then, and not back yet

  bool away() const { return away_since_us >= 0; }
  bool plays() const { return rods != 0; }
};

class Seats {
 public:
  // mixed_teams: a client from another machine, too, may have rods of both teams.
  Seats(foosball::Layout layout, bool mixed_teams) : layout_(layout), mixed_teams_(mixed_teams) {}

  const std::vector<Seat>& all() const { return seats_; }
  Seat* find(std::uint32_t client);
  const Seat* find(std::uint32_t client) const;
  Seat* find_ticket(std::uint64_t ticket);
  Seat& add(Seat seat) { return seats_.emplace_back(std::move(seat)); }
  void remove(std::uint32_t client);
  int of_machine(const os::SocketAddress& peer) const;
  // The name of who has this seat, or is to have it, in this team: the one that it has, else the
  // one that is wanted, or that with a number behind it where another is here under it, of another
  // owner or of another team, or where results have it for who is no person with a name (computer,
  // cabinet, nobody). Results and ratings go by names, so that nobody has another one without need.
  std::string name_for(const Seat& seat, std::uint8_t team) const;
  // The same for one of several people at this seat, who plays this rod; empty: the seat's own.
  std::string player_name(const Seat& seat, const std::string& wanted, int rod) const;
  int of_network(const os::SocketAddress& peer) const;

  struct Grant {
    enum class Kind : std::uint8_t { granted, taken, other_team, none };
    Kind kind = Kind::none;
    RodSet rods = 0;          // granted
    wire::Sentence sentence;  // else why not, and what to do
  };
  // What somebody of this team may have of the rods wanted; 0: all of the team that are free.
  // client: whose own rods count as free; 0: nobody's. trusted: at this machine, or the host.
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
