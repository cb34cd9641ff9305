// The people at this client: who plays which rods with which devices, and the targets of all their
// rods.
//
// Devices without rods of their own belong to the first person. The first person plays, with any of
// them, all rods that nobody else here has. A device that is given rods becomes a separate person.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <vector>

#include "client/devices.h"
#include "client/player_input.h"

namespace client {

class Crew {
 public:
  static constexpr int kFirstPerson = -1;

  // granted: rods of the Welcome, by bit; team: of the Welcome, 0 or 1, the first person's.
  Crew(std::uint64_t session, int team, foosball::Layout layout, std::uint8_t granted);

  // Sets the rods that the server grants this client, and its team, 0 or 1. Other rods are no
  // longer driven.
  void grant(int team, std::uint8_t rods);
  // Assigns this rod to a device or to the first person. A device plays one team: its rods of the
  // other team go to the first person. A rod that is not granted can be assigned too; it is played
  // once it is granted.
  void give(int rod, int device);
  int player_of(int rod) const { return owner_[static_cast<std::size_t>(rod)]; }
  DeviceSet devices_of(int device) const;

  void set_assists(const foosball::AssistChoice& choice);
  // Sets the characters that the match offers; the built-in ones until this is called.
  void set_characters(const foosball::Characters& characters);
  // Processes one frame. take: returns the input events of these devices.
  using Take = std::function<InputEvents(DeviceSet)>;
  void update(const Take& take, const wire::Snapshot* scene, std::int64_t now_us);

  std::uint64_t session() const { return session_; }
  int team() const { return team_; }
  bool plays() const { return !people_.empty(); }
  std::uint8_t granted() const { return granted_; }
  bool begun() const { return begun_; }
  bool automatic() const { return assists_.automatic_rod; }
  std::array<wire::InputRod, 8> rods() const;
  std::vector<wire::MatchRequest> requests() const;
  std::uint8_t active_rods() const;  // rods that a person here drives, by bit
  // Each person's device, or kFirstPerson, and rods.
  struct Hands {
    int device;
    std::uint8_t rods;
  };
  std::vector<Hands> hands() const;
  int people() const { return static_cast<int>(people_.size()); }

 private:
  struct Person {
    int device;
    std::uint8_t rods;
    PlayerInput input;
  };
  void seat_people();
  void seat(int device, int team, std::uint8_t rods);
  int team_of(int rod) const { return table_.rods[static_cast<std::size_t>(rod)].team; }

  std::uint64_t session_;
  int team_;
  foosball::Layout layout_;
  const foosball::TableSpec& table_;
  std::uint8_t granted_;
  std::array<int, foosball::kRods> owner_;
  foosball::AssistChoice assists_;
  foosball::Characters characters_ = foosball::built_in_characters();
  bool begun_ = false;
  std::list<Person> people_;
};

}  // namespace client
