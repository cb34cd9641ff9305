// The page of seats: who plays which rods, here and at other clients. Rods can be taken, assigned
// to a device and given up. Also votes and time-outs. No drawing here.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/crew.h"
#include "client/menu_page.h"
#include "wire/control.h"
#include "wire/snapshot.h"

namespace client {

// The data that the page shows.
struct SeatsView {
  std::uint32_t client = 0;  // this client's number
  std::uint8_t role = 0;     // wire::Role
  wire::Roster roster;
  wire::Snapshot scene;
  DeviceSet pads = 0;                 // pads that are plugged in
  wire::RodPlayers own_names;         // by rod: names of people here who have set one
  std::vector<wire::Notice> notices;  // the page offers the votes among them
};

// Requests to the server.
struct SeatsAsked {
  std::optional<wire::Claim> claim;
  std::vector<wire::MatchRequest> requests;
  std::optional<wire::Kick> kick;
};

class SeatsMenu {
 public:
  int rows(const SeatsView& view) const;
  MenuPage page(const SeatsView& view, const Crew& crew, int chosen) const;
  // Assigns rods to devices of the crew. Rods that the server has not granted yet are requested.
  SeatsAsked step(const SeatsView& view, int row, const MenuSteps& steps, Crew& crew);

 private:
  const wire::Seat* person_at(const SeatsView& view, int row) const;
  std::optional<wire::Claim> change_rod(const SeatsView& view, int rod, int way, Crew& crew);
  std::optional<wire::Claim> claim_of(std::uint8_t rods, int team, const Crew& crew) const;

  std::uint32_t armed_ = 0;  // the client to be removed if it is chosen once more; 0: none
};

// The player of each rod, by index. Empty for rods without a player, and for all rods while one
// person plays alone.
struct RodName {
  std::string text;
  bool translate = false;
  int number = 0;  // after the text; 0: none
};
std::array<RodName, 8> names_at_rods(const SeatsView& view, const Crew& crew);

}  // namespace client
