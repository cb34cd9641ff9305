// Who drives which rod: the cabinet's sensors first, then the client that has the rod. The computer
// has the rods of a team without a person; where people have only some of a team's rods, it has the
// others if the options say so. In a match it also stands in for a person who is lost, silent, idle
// or has left, until the person is back or somebody takes the rods. Built on cabinet::SourceMux,
// which keeps rods from jumping when the driver changes.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "cabinet/device.h"
#include "cabinet/source_mux.h"
#include "computer_source.h"
#include "foosball/match.h"
#include "hand_watch.h"
#include "remote_source.h"

namespace server {

// RodSnapshot::source.
enum class RodDriver : std::uint8_t { none, cabinet, client, computer, replay };

class RodDesk {
 public:
  // computer: teams that a computer plays while no client has rods of them. computer_fills: and
  // their rods that nobody has. view must outlive the desk.
  RodDesk(const foosball::MatchDesc& match, const std::array<bool, foosball::kTeams>& computer,
          bool computer_fills, const foosball::PlayerSpec& computer_player,
          const foosball::MatchView& view);

  void add_device(std::unique_ptr<cabinet::Device> device);
  const std::vector<std::unique_ptr<cabinet::Device>>& devices() const { return devices_; }

  // The client has these rods, by bit, from now on, and no others; 0: none. Takes no memory.
  // Preconditions: no rod is another client's. Returns where its inputs go; null: it has no rod.
  RemoteSource* seat(std::uint32_t client, std::uint8_t rods, std::int64_t now_us);
  // As seat(), for a client that is there: the rods of a team of which it keeps none are vacated,
  // as if it had left.
  RemoteSource* change(std::uint32_t client, std::uint8_t rods, std::int64_t now_us);
  RemoteSource* remote(std::uint32_t client);  // null: it has no rod
  // The client's connection is lost, and expected back; it is back.
  void lost(std::uint32_t client);
  void back(std::uint32_t client);
  // The client has left for good. Its rods are offered to its team mates first, if it has any.
  void leave(std::uint32_t client, std::int64_t now_us);
  // Each tick: whom the computer stands in for, where somebody else is there to play with or
  // against. True: it changed. in_match: there is a match to keep going; what was vacated in
  // another is forgotten. in_play: the ball is in play, so that hands have something to do.
  bool watch_absences(bool in_match, bool in_play, std::int64_t now_us);
  std::uint8_t stand_ins() const { return stand_ins_; }  // rods that the computer plays so
  std::uint8_t offered() const { return offered_; }      // to team mates, by watch_absences()
  // There are players, and nothing is heard of any of them, as of watch_absences().
  bool all_silent() const { return all_silent_; }

  // How long nothing may be heard of a person's hand until the computer stands in: more than a gap
  // in a line, less than it takes to concede.
  static constexpr std::int64_t kStandInAfterUs = 3'000'000;
  // How long of play a hand that is there may move none of its team's rods until the computer
  // stands in: as long as an opponent may hold the ball on his midfield (10 s) and his attack
  // (15 s).
  static constexpr std::int64_t kIdleUs = 25'000'000;
  // How long team mates are offered the rods of one who left.
  static constexpr std::int64_t kOfferUs = 10'000'000;

  // Computers play both teams, whoever has them: a match is shown while nobody plays.
  void show_match(bool shown);
  // A hand has moved a rod of a device or a client since the match is shown.
  bool hand_moved() const;
  // Another computer player is chosen; it comes when the next match does, in a game that leaves the
  // choice.
  void choose_player(const foosball::PlayerSpec& player) { chosen_ = player; }
  bool player_waits() const { return !(chosen_ == player_); }
  // Each tick, before poll(): who plays where a computer does, as the game has it; at each try of a
  // challenge the same, and in the same state.
  void follow(const foosball::MatchView& view);
  // Who plays where a computer does.
  const foosball::PlayerSpec& computer_player() const { return seated_; }

  void poll(std::int64_t now_us);
  const cabinet::RodInputs& rods() const { return mux_.rods(); }
  RodDriver driver(int rod) const;
  std::uint32_t client_of(int rod) const;  // that has it; 0: none
  bool of_device(int rod) const;           // a device has it, also while the computer stands in

 private:
  struct Place {
    std::uint32_t client = 0;  // 0: nobody
    std::uint8_t rods = 0;
    int index = cabinet::SourceMux::kNobody;  // the mux's
    std::unique_ptr<RemoteSource> remote;
    bool lost = false;  // its connection; expected back
  };

  int add(cabinet::InputSource& source, cabinet::Origin origin, RodDriver kind);
  void assign_all();
  foosball::ComputerPlayerDesc computer_desc(int team) const;
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t owner(int rod) const;  // of the sources that hands drive, or kNone
  bool silent(std::size_t source, std::uint8_t rods, std::int64_t now_us) const;
  bool gone(std::size_t source, std::uint8_t rods, std::int64_t now_us) const;
  void look_at_hands(bool in_match, bool in_play, std::int64_t now_us);
  std::uint8_t rods_of_gone(bool& somebody, std::int64_t now_us);
  std::uint8_t given_up(std::uint32_t client, std::uint8_t rods) const;
  bool may_be_offered(std::uint32_t client, std::uint8_t rods, std::int64_t now_us) const;
  void vacate(std::uint8_t rods, bool offer, std::int64_t now_us);
  bool has_team_mate(std::uint32_t client, std::uint8_t rods, std::int64_t now_us) const;
  const cabinet::RodInput& hand(std::size_t source, int rod) const;

  const foosball::TableSpec& table_;
  std::vector<std::unique_ptr<cabinet::Device>> devices_;
  std::array<Place, foosball::kRods> places_;  // one for each client that has a rod
  std::array<std::unique_ptr<ComputerSource>, foosball::kTeams> computers_;
  std::uint8_t computed_ = 0;  // rods that a computer plays unless a device has them, by bit
  bool computer_fills_;
  foosball::PlayerSpec player_, chosen_;  // in this match; from the next one on
  foosball::PlayerSpec seated_;           // by what the game has
  std::array<bool, foosball::kTeams>
      computer_allowed_{};  // else it plays only a match that is shown
  std::uint64_t seed_ = 0;  // the match's, or the challenge's
  std::uint64_t match_seed_ = 0;
  bool under_way_ = false;  // a match, as follow() saw it
  bool shown_ = false;
  std::uint8_t vacated_ = 0;  // by who left in this match, or the team; nobody has taken them since
  std::array<std::int64_t, foosball::kRods> offered_until_us_{};
  std::uint8_t stand_ins_ = 0, offered_ = 0;
  HandWatch hand_watch_;         // by source: clients' places, then devices
  std::int64_t play_us_ = 0;     // time of play
  std::int64_t looked_us_ = -1;  // negative: not yet
  bool in_match_ = false, all_silent_ = false;
  std::vector<cabinet::RodInputs> hands_;  // where each device and client had the rods then
  cabinet::SourceMux mux_;
  std::vector<RodDriver> kinds_;                         // by the mux's index
  std::vector<int> order_{cabinet::SourceMux::kNobody};  // the devices', then the rod's player
  std::array<int, foosball::kTeams> computer_index_{};
};

}  // namespace server
