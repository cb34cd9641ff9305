// The page of seats: who plays which rods, here and at other clients; taking rods, giving them to a
// device, giving them up; votes and time-outs. No drawing here.
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

// What the page is made of.
struct SeatsView {
  std::uint32_t client = 0;  // this one's number
  std::uint8_t role = 0;     // wire::Role
  wire::Roster roster;
  wire::Snapshot scene;
  DeviceSet pads = 0;                 // those that are plugged in
  wire::RodPlayers own_names;         // of people here who have said how they are called, by rod
  std::vector<wire::Notice> notices;  // the votes among them are offered
};

// What is asked of the server.
struct SeatsAsked {
  std::optional<wire::Claim> claim;
  std::vector<wire::MatchRequest> requests;
  std::optional<wire::Kick> kick;
};

class SeatsMenu {
 public:
  int rows(const SeatsView& view) const;
  MenuPage page(const SeatsView& view, const Crew& crew, int chosen) const;
  // Gives rods to devices of the crew; the server is asked for those that it has not granted yet.
  SeatsAsked step(const SeatsView& view, int row, const MenuSteps& steps, Crew& crew);

 private:
  const wire::Seat* person_at(const SeatsView& view, int row) const;
  std::optional<wire::Claim> change_rod(const SeatsView& view, int rod, int way, Crew& crew);
  std::optional<wire::Claim> claim_of(std::uint8_t rods, int team, const Crew& crew) const;

  std::uint32_t armed_ = 0;  // who is put out if it is asked for once more; 0: nobody
};

// Of each rod, by index: who plays it. Empty where nobody does, and everywhere while one person
// plays alone.
struct RodName {
  std::string text;
  bool translate = false;
  int number = 0;  // after it; 0: none
};
std::array<RodName, 8> names_at_rods(const SeatsView& view, const Crew& crew);

}  // namespace client
