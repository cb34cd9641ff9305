// Assigns the rods to their drivers. Priority: the cabinet's sensors, then the client that has the
// rod, then the computer. The computer plays the rods of a team without a person. If people have
// only some of a team's rods, it plays the others if the options say so. In a match it also stands
// in for a person who is disconnected, silent, idle or has left, until that person returns or
// somebody takes the rods. Uses cabinet::SourceMux, which prevents a rod from jumping when its
// driver changes.
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
  // computer: teams that a computer plays while no client has rods of them. computer_fills: it also
  // plays unassigned rods of a team that people play. view must outlive the desk.
  RodDesk(const foosball::MatchDesc& match, const std::array<bool, foosball::kTeams>& computer,
          bool computer_fills, const foosball::PlayerSpec& computer_player,
          const foosball::MatchView& view);

  void add_device(std::unique_ptr<cabinet::Device> device);
  const std::vector<std::unique_ptr<cabinet::Device>>& devices() const { return devices_; }

  // Gives these rods (bit mask) to the client, in place of those it had; 0: none. Does not
  // allocate. Returns the destination of its inputs; null: it has no rods. Precondition: no rod
  // belongs to another client.
  RemoteSource* seat(std::uint32_t client, std::uint8_t rods, std::int64_t now_us);
  // Like seat(), for a client that already has rods. If it keeps no rod of a team, those rods are
  // vacated, as by leave().
  RemoteSource* change(std::uint32_t client, std::uint8_t rods, std::int64_t now_us);
  RemoteSource* remote(std::uint32_t client);  // null: it has no rod
  // The client's connection was lost, and its seat is reserved; the client has returned.
  void lost(std::uint32_t client);
  void back(std::uint32_t client);
  // The client has left for good. Its rods are first offered to its team mates, if it has any.
  void leave(std::uint32_t client, std::int64_t now_us);
  // Call each tick. Updates the rods for which the computer stands in, if others are there to play
  // with or against. Returns true if they changed. in_match: a match is in progress; rods vacated
  // in an earlier one are forgotten. in_play: the ball is in play, so that a hand has a reason to
  // move.
  bool watch_absences(bool in_match, bool in_play, std::int64_t now_us);
  std::uint8_t stand_ins() const { return stand_ins_; }  // rods with a stand-in
  std::uint8_t offered() const { return offered_; }      // to team mates, by watch_absences()
  // True if there are players but none of them sends anything, as of watch_absences().
  bool all_silent() const { return all_silent_; }

  // Silence of a person's hand after which the computer stands in: longer than a network outage,
  // shorter than conceding a goal takes.
  static constexpr std::int64_t kStandInAfterUs = 3'000'000;
  // Play time without motion of the team's rods after which the computer stands in for a connected
  // hand: the time that an opponent may hold the ball on his midfield (10 s) plus his attack (15
  // s).
  static constexpr std::int64_t kIdleUs = 25'000'000;
  // Time for which team mates are offered the rods of a player who left.
  static constexpr std::int64_t kOfferUs = 10'000'000;

  // Computers play both teams, even assigned rods: a demonstration match while nobody plays.
  void show_match(bool shown);
  // True if a hand has moved a rod of a device or a client since the demonstration match began.
  bool hand_moved() const;
  // Chooses another computer player. It takes effect with the next match, in modes that allow the
  // choice.
  void choose_player(const foosball::PlayerSpec& player) { chosen_ = player; }
  bool player_waits() const { return !(chosen_ == player_); }
  // Call each tick before poll(). Selects the computer player of the current mode. Each attempt at
  // a challenge starts with the same player in the same state.
  void follow(const foosball::MatchView& view);
  // The current computer player.
  const foosball::PlayerSpec& computer_player() const { return seated_; }

  void poll(std::int64_t now_us);
  const cabinet::RodInputs& rods() const { return mux_.rods(); }
  RodDriver driver(int rod) const;
  std::uint32_t client_of(int rod) const;  // the client that has it; 0: none
  bool of_device(int rod) const;           // a device has it, also while the computer stands in

 private:
  struct Place {
    std::uint32_t client = 0;  // 0: nobody
    std::uint8_t rods = 0;
    int index = cabinet::SourceMux::kNobody;  // in the mux
    std::unique_ptr<RemoteSource> remote;
    bool lost = false;  // disconnected, seat reserved
  };

  int add(cabinet::InputSource& source, cabinet::Origin origin, RodDriver kind);
  void assign_all();
  foosball::ComputerPlayerDesc computer_desc(int team) const;
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t owner(int rod) const;  // index of the hand-driven source, or kNone
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
  std::array<Place, foosball::kRods> places_;  // one per client that has a rod
  std::array<std::unique_ptr<ComputerSource>, foosball::kTeams> computers_;
  std::uint8_t computed_ = 0;  // bit mask: rods that a computer plays unless a device has them
  bool computer_fills_;
  foosball::PlayerSpec player_, chosen_;                   // of this match; from the next one on
  foosball::PlayerSpec seated_;                            // selected by the mode
  std::array<bool, foosball::kTeams> computer_allowed_{};  // false: only demonstration matches
  std::uint64_t seed_ = 0;                                 // of the match, or of the challenge
  std::uint64_t match_seed_ = 0;
  bool under_way_ = false;  // a match, as of follow()
  bool shown_ = false;
  std::uint8_t vacated_ = 0;  // in this match, by leaving or changing teams, and not taken since
  std::array<std::int64_t, foosball::kRods> offered_until_us_{};
  std::uint8_t stand_ins_ = 0, offered_ = 0;
  HandWatch hand_watch_;         // by source: clients' places, then devices
  std::int64_t play_us_ = 0;     // time of play
  std::int64_t looked_us_ = -1;  // negative: not yet
  bool in_match_ = false, all_silent_ = false;
  std::vector<cabinet::RodInputs> hands_;  // rod inputs of each source when the demonstration began
  cabinet::SourceMux mux_;
  std::vector<RodDriver> kinds_;                         // by the mux's index
  std::vector<int> order_{cabinet::SourceMux::kNobody};  // the devices, then the rod's player
  std::array<int, foosball::kTeams> computer_index_{};
};

}  // namespace server
