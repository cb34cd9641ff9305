// The names of the people at this client, and which of them to send to the server. Results and
// ratings are stored by name, and a player who changes the name during a match has left it. So
// names change only between matches.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "client/crew.h"
#include "client/settings.h"
#include "wire/control.h"

namespace client {

class CrewNames {
 public:
  // Call once a frame. Returns the names to send now; none: the server has them.
  std::optional<wire::Names> update(const Crew& crew, const Settings& settings, bool in_match);
  // The client has joined again: a seat that is taken again may still have its earlier names.
  void joined() { reported_.reset(); }
  // By rod: the player's name where a person has set one; else empty.
  const wire::RodPlayers& set_names() const { return set_; }

 private:
  void place_people(const Crew& crew, bool in_match);

  std::array<int, kDevices + 1> places_ = none();  // by device + 1: person's index; -1: none
  Settings named_;                                 // the settings whose names are in use
  bool named_once_ = false;
  std::optional<wire::Names> reported_;
  wire::RodPlayers set_;

  static constexpr std::array<int, kDevices + 1> none() {
    std::array<int, kDevices + 1> places{};
    places.fill(-1);
    return places;
  }
};

}  // namespace client
