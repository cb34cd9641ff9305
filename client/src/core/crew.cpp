#include "client/crew.h"

#include <algorithm>

namespace client {

Crew::Crew(std::uint64_t session, int team, foosball::Layout layout, std::uint8_t granted)
    : session_(session),
      team_(team),
      layout_(layout),
      table_(foosball::table_spec(layout)),
      granted_(granted) {
  owner_.fill(kFirstPerson);
  seat_people();
}

void Crew::grant(int team, std::uint8_t rods) {
  if (rods == granted_ && team == team_) return;
  granted_ = rods;
  team_ = team;
  seat_people();
}

void Crew::give(int rod, int device) {
  if (rod < 0 || rod >= foosball::kRods || device < kFirstPerson || device >= kDevices) return;
  for (int other = 0; other < foosball::kRods && device != kFirstPerson; ++other) {
    int& owner = owner_[static_cast<std::size_t>(other)];
    if (owner == device && team_of(other) != team_of(rod)) owner = kFirstPerson;
  }
  owner_[static_cast<std::size_t>(rod)] = device;
  seat_people();
}

DeviceSet Crew::devices_of(int device) const {
  if (device != kFirstPerson) return bit_of(static_cast<Device>(device));
  DeviceSet devices = kAllDevices;
  for (const Person& person : people_) {
    if (person.device != kFirstPerson)
      devices = static_cast<DeviceSet>(devices & ~bit_of(static_cast<Device>(person.device)));
  }
  return devices;
}

void Crew::seat_people() {
  std::array<std::array<std::uint8_t, kDevices + 1>, foosball::kTeams> rods{};
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if ((granted_ >> rod & 1) == 0) continue;
    const auto person = static_cast<std::size_t>(owner_[static_cast<std::size_t>(rod)] + 1);
    rods[static_cast<std::size_t>(team_of(rod))][person] |= static_cast<std::uint8_t>(1u << rod);
  }
  for (int device = kFirstPerson; device < kDevices; ++device) {
    const auto person = static_cast<std::size_t>(device + 1);
    // The first person plays rods of their own team, or of the other team if there are none.
    int team = team_;
    if (rods[static_cast<std::size_t>(team)][person] == 0) team = 1 - team;
    seat(device, team, rods[static_cast<std::size_t>(team)][person]);
  }
}

// A person whose rods are unchanged keeps their state.
void Crew::seat(int device, int team, std::uint8_t rods) {
  const auto person = std::ranges::find(people_, device, &Person::device);
  if (person != people_.end()) {
    if (person->rods == rods) return;
    people_.erase(person);
  }
  if (rods == 0) return;
  people_.push_back({device, rods, PlayerInput(session_, team, layout_, rods)});
  people_.back().input.set_assists(assists_);
  people_.back().input.set_characters(characters_);
}

void Crew::set_assists(const foosball::AssistChoice& choice) {
  assists_ = choice;
  for (Person& person : people_) person.input.set_assists(choice);
}

void Crew::set_characters(const foosball::Characters& characters) {
  characters_ = characters;
  for (Person& person : people_) person.input.set_characters(characters);
}

void Crew::update(const Take& take, const wire::Snapshot* scene, std::int64_t now_us) {
  begun_ = begun_ || (scene != nullptr && scene->session == session_);
  for (Person& person : people_) {
    const InputEvents events = take(devices_of(person.device));
    person.input.update(events, scene, now_us);
    if (events.toggle_automatic) assists_.automatic_rod = person.input.automatic();
  }
  set_assists(assists_);
}

std::array<wire::InputRod, 8> Crew::rods() const {
  std::array<wire::InputRod, 8> rods{};
  for (const Person& person : people_) {
    const auto own = person.input.rods();
    for (std::size_t i = 0; i < rods.size(); ++i) {
      if (own[i].driven) rods[i] = own[i];
    }
  }
  return rods;
}

std::vector<wire::MatchRequest> Crew::requests() const {
  std::vector<wire::MatchRequest> all;
  for (const Person& person : people_) {
    const auto& own = person.input.requests();
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

std::vector<Crew::Hands> Crew::hands() const {
  std::vector<Hands> all;
  for (const Person& person : people_) all.push_back({person.device, person.rods});
  return all;
}

std::uint8_t Crew::active_rods() const {
  std::uint8_t rods = 0;
  for (const Person& person : people_)
    rods |= static_cast<std::uint8_t>(1u << person.input.active_rod());
  return rods;
}

}  // namespace client
