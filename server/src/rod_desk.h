// Who drives which rod: the cabinet's sensors first, then the client that has the team, or the
// computer where no client has it. Built on cabinet::SourceMux, which keeps rods from jumping when
// the driver changes.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "cabinet/device_source.h"
#include "cabinet/source_mux.h"
#include "computer_source.h"
#include "foosball/match.h"
#include "remote_source.h"

namespace server {

// RodSnapshot::source.
enum class RodDriver : std::uint8_t { none, cabinet, client, computer, replay };

class RodDesk {
 public:
  // computer: teams that a computer plays while no client has them. view must outlive the desk.
  RodDesk(const foosball::MatchDesc& match, const std::array<bool, foosball::kTeams>& computer,
          const foosball::MatchView& view);

  void add_device(std::unique_ptr<cabinet::DeviceSource> device);
  const std::vector<std::unique_ptr<cabinet::DeviceSource>>& devices() const { return devices_; }

  // A client has taken the team, or given it up.
  void set_claimed(int team, bool claimed);
  RemoteSource& remote(int team) { return *remotes_[team]; }

  // Computers play both teams, whoever has them: a match is shown while nobody plays.
  void show_match(bool shown);
  // A hand has moved a rod of a device or a client since the match is shown.
  bool hand_moved() const;
  // The opponent at a rung of the ladder: stronger from one to the next.
  void set_rung(int rung);

  void poll(std::int64_t now_us) { mux_.poll(now_us); }
  const cabinet::RodInputs& rods() const { return mux_.rods(); }
  RodDriver driver(int rod) const;

 private:
  int add(cabinet::InputSource& source, cabinet::Origin origin, RodDriver kind);
  void assign_all();
  foosball::ComputerPlayerDesc computer_desc(int team) const;
  const cabinet::RodInput& hand(std::size_t source, int rod) const;

  const foosball::TableSpec& table_;
  std::vector<std::unique_ptr<cabinet::DeviceSource>> devices_;
  std::array<std::unique_ptr<RemoteSource>, foosball::kTeams> remotes_;
  std::array<std::unique_ptr<ComputerSource>, foosball::kTeams> computers_;
  std::array<bool, foosball::kTeams>
      computer_allowed_{};  // else it plays only a match that is shown
  std::array<bool, foosball::kTeams> claimed_{};
  std::uint64_t seed_ = 0;
  int rung_ = -1;  // not on the ladder
  bool shown_ = false;
  std::vector<cabinet::RodInputs> hands_;  // where each device and client had the rods then
  cabinet::SourceMux mux_;
  std::vector<RodDriver> kinds_;                         // by the mux's index
  std::vector<int> order_{cabinet::SourceMux::kNobody};  // the devices', then the team's player
  std::array<int, foosball::kTeams> remote_index_{}, computer_index_{};
};

}  // namespace server
