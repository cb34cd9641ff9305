#include "client/crew_names.h"

#include <algorithm>

namespace client {

// Between matches people are numbered again, in the order of their devices. During a match a new
// person gets the next number.
void CrewNames::place_people(const Crew& crew, bool in_match) {
  if (!in_match) places_ = none();
  std::vector<int> devices;
  for (const Crew::Hands& hands : crew.hands()) devices.push_back(hands.device);
  std::ranges::sort(devices);
  for (const int device : devices) {
    int& place = places_[static_cast<std::size_t>(device + 1)];
    if (place < 0) place = std::ranges::max(places_) + 1;
  }
}

std::optional<wire::Names> CrewNames::update(const Crew& crew, const Settings& settings,
                                             bool in_match) {
  if (!in_match || !named_once_) named_.names = settings.names;
  named_once_ = true;
  place_people(crew, in_match);
  wire::Names names{name_of_person(named_, 0), {}};
  set_ = {};
  for (const Crew::Hands& hands : crew.hands()) {
    const auto place =
        static_cast<std::size_t>(places_[static_cast<std::size_t>(hands.device + 1)]);
    const std::string name = name_of_person(named_, place);
    const bool is_set = place < named_.names.size() && !named_.names[place].empty();
    for (std::size_t rod = 0; rod < names.players.size(); ++rod) {
      if ((hands.rods >> rod & 1) == 0) continue;
      if (place > 0) names.players[rod] = name;
      if (is_set) set_[rod] = name;
    }
  }
  if (reported_ && names.name == reported_->name && names.players == reported_->players)
    return std::nullopt;
  reported_ = names;
  return names;
}

}  // namespace client
