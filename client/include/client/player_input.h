// One person's hand at this client: what they did in, their rods out, helped by the assists that
// they chose (foosball/assists.h).
//
// The person stands at the long side, as camera.h has it: away from them is along the rod, to their
// right is towards the other goal.
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
  // rods: that the person plays, by bit; those of the other team are ignored. Precondition: team
  // is 0 or 1.
  PlayerInput(std::uint64_t session, int team, foosball::Layout layout, std::uint8_t rods = 0xff);

  // One frame: what happened at the window, and the newest scene (null: none yet). A scene of
  // another session counts as none. Until there is one, the hand holds no rod, asks for nothing,
  // and only chooses its line.
  void update(const InputEvents& events, const wire::Snapshot* scene, std::int64_t now_us);

  std::uint64_t session() const { return session_; }
  // A scene of the session was there: the rods are known, and may be driven.
  bool begun() const { return begun_; }
  // None is driven before begun().
  std::array<wire::InputRod, 8> rods() const;
  // What the events of the last update ask of the match.
  const std::vector<wire::MatchRequest>& requests() const { return requests_; }
  int team() const { return team_; }
  int active_rod() const { return hand_.active_rod(); }  // one of its rods
  bool automatic() const { return assists_on_.automatic_rod; }
  void set_assists(const foosball::AssistChoice& choice);
  // That the match has to choose from, at least one; the built-in ones until this is called.
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
  int rod_to_take_ = -1;          // by the assist; a rod chosen by hand stays until it changes
  std::int64_t assisted_us_ = 0;  // up to when
  std::int64_t acted_us_ = -1;    // when the person last did anything; negative: no frame yet
  std::uint8_t drives_ = 0;       // rods that were this client's in a scene, by bit
  std::array<foosball::RodTarget, foosball::kRods> targets_{};
  bool begun_ = false;
  foosball::Characters characters_ = foosball::built_in_characters();
  bool key_was_held_ = false;
  // Training: whom the person chose last, and when; the scene has him a little later.
  int fed_rod_ = -1, fed_man_ = 0;
  std::int64_t fed_us_ = 0;
  std::vector<wire::MatchRequest> requests_;
};

}  // namespace client
