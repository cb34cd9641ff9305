// One person's input at this client: input events in, rod targets out. The assists that the person
// chose help (foosball/assists.h).
//
// The person stands at the long side, as in camera.h: away from the person is along the rod, right
// is towards the opponents' goal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cabinet/hand.h"
#include "client/input_events.h"
#include "foosball/assists.h"
#include "foosball/table.h"
#include "wire/control.h"
#include "wire/input_datagram.h"
#include "wire/snapshot.h"

namespace client {

class PlayerInput {
 public:
  // rods: the person's rods, by bit; rods of the other team are ignored. Precondition: team is 0 or
  // 1.
  PlayerInput(std::uint64_t session, int team, foosball::Layout layout, std::uint8_t rods = 0xff);

  // Processes one frame: the input events, and the newest scene (null: none yet). A scene of
  // another session counts as none. Until there is a scene, this drives no rod, makes no request
  // and only selects the line.
  void update(const InputEvents& events, const wire::Snapshot* scene, std::int64_t now_us);

  std::uint64_t session() const { return session_; }
  // A scene of the session has arrived: the rods are known and may be driven.
  bool begun() const { return begun_; }
  // No rod is driven before begun().
  std::array<wire::InputRod, 8> rods() const;
  // The requests to the match from the events of the last update.
  const std::vector<wire::MatchRequest>& requests() const { return requests_; }
  int team() const { return team_; }
  int active_rod() const { return hand_.active_rod(); }  // one of the person's rods
  bool automatic() const { return assists_on_.automatic_rod; }
  void set_assists(const foosball::AssistChoice& choice);
  // Sets the characters that the match offers, at least one; the built-in ones until this is
  // called.
  void set_characters(const foosball::Characters& characters) { characters_ = characters; }

 private:
  void move(const InputEvents& events, const wire::Snapshot& scene);
  void collect_requests(const InputEvents& events, const wire::Snapshot& scene,
                        std::int64_t now_us);
  void choose_character(const InputEvents& events, const wire::Snapshot& scene);
  void choose_man(int presses, const wire::Snapshot& scene, std::int64_t now_us);
  void choose_rod(const foosball::AssistView& view);
  void assist(const foosball::AssistView& view, std::int64_t now_us);
  void rest();
  foosball::AssistHand hand_now() const;

  std::uint64_t session_;
  int team_;
  const foosball::TableSpec& table_;
  std::uint8_t mine_;  // by bit
  cabinet::Hand hand_;
  foosball::AssistChoice assists_on_;
  foosball::Assists assists_;
  int rod_to_take_ = -1;          // by the assist; a rod chosen by hand stays until this changes
  std::int64_t assisted_us_ = 0;  // the assists have run up to this time
  std::int64_t acted_us_ = -1;    // time of the person's last input; negative: no frame yet
  std::uint8_t drives_ = 0;       // rods that a scene has shown as this client's, by bit
  std::array<foosball::RodTarget, foosball::kRods> targets_{};
  bool begun_ = false;
  foosball::Characters characters_ = foosball::built_in_characters();
  bool key_was_held_ = false;
  // Training: the man whom the person chose last, and when. The scene shows him a little later.
  int fed_rod_ = -1, fed_man_ = 0;
  std::int64_t fed_us_ = 0;
  std::vector<wire::MatchRequest> requests_;
};

}  // namespace client
