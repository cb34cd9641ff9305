// A person's hand at this client: window events in, the rods of their team out.
//
// The person stands at the long side, as camera.h has it: away from them is along the rod, to their
// right is towards the other goal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cabinet/hand.h"
#include "client/input_events.h"
#include "foosball/table.h"
#include "wire/control.h"
#include "wire/input_datagram.h"
#include "wire/snapshot.h"

namespace client {

class PlayerInput {
 public:
  // Precondition: team is 0 or 1.
  PlayerInput(std::uint64_t session, int team, foosball::Layout layout);

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
  const std::vector<wire::Wish>& wishes() const { return wishes_; }
  int active_rod() const { return hand_.active_rod(); }
  bool automatic() const { return automatic_; }
  void set_automatic(bool on) { automatic_ = on; }

 private:
  void move(const InputEvents& events, const wire::Snapshot& scene);
  void collect_wishes(const InputEvents& events, const wire::Snapshot& scene);
  void choose_character(const InputEvents& events, const wire::Snapshot& scene);

  std::uint64_t session_;
  int team_;
  const foosball::TableSpec& table_;
  cabinet::Hand hand_;
  bool begun_ = false;
  bool automatic_ = false;
  bool key_was_held_ = false;
  std::array<double, 8> rod_x_{};
  std::vector<wire::Wish> wishes_;
};

}  // namespace client
