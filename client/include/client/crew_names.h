// How the people at this client are called, and what of it the server has to be told. Results and
// ratings go by names, and who changes the name in a match has left it: names change between
// matches only.
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
  // Once a frame. What the server is to be told now; none: it knows.
  std::optional<wire::Names> update(const Crew& crew, const Settings& settings, bool in_match);
  // The server was joined again: a seat that is taken again may have names of before.
  void joined() { told_.reset(); }
  // By rod: of whoever has set a name; empty: of nobody.
  const wire::RodPlayers& set_names() const { return set_; }

 private:
  void place_people(const Crew& crew, bool in_match);

  std::array<int, kDevices + 1> places_ = none();  // by device + 1: which person; -1: nobody yet
  Settings named_;                                 // whose names are in use
  bool named_once_ = false;
  std::optional<wire::Names> told_;
  wire::RodPlayers set_;

  static constexpr std::array<int, kDevices + 1> none() {
    std::array<int, kDevices + 1> places{};
    places.fill(-1);
    return places;
  }
};

}  // namespace client
