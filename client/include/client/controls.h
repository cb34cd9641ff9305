// The actions of the keyboard, and how presses become axes. Keys are followed by their events and
// not polled once a frame: a tap that begins and ends between two frames counts too. Independent of
// the window library.
#pragma once

#include <array>
#include <cstdint>

namespace client {

enum class Action : std::uint8_t {
  slide_away,
  slide_near,
  spin_right,
  spin_left,
  rod_1,  // goalie
  rod_2,
  rod_3,
  rod_4,  // attack
  next_rod,
  previous_rod,
  push,
  pause,
  automatic,
  camera,
  settings,
  help,
  seats,
  tuning,
  time_out,
  recordings,
  game,
  controllers,
  feed,  // training: give the ball to the next man of the active rod
};
inline constexpr int kActions = 23;

constexpr std::size_t index_of(Action action) {
  return static_cast<std::size_t>(action);
}

// Key presses between two frames. Several keys may be bound to one action.
class ActionState {
 public:
  void press(Action action);
  void release(Action action);
  void release_all();  // the window lost the focus

  bool held(Action action) const { return down_[index_of(action)] > 0; }
  // Since the last clear(): the number of presses, and how many of them were also released before
  // it.
  int presses(Action action) const { return presses_[index_of(action)]; }
  int taps(Action action) const { return taps_[index_of(action)]; }
  // An axis between two actions: -1, 0 or 1 while held; taps with their sign.
  double axis(Action forward, Action back) const;
  int tapped(Action forward, Action back) const { return taps(forward) - taps(back); }
  void clear();  // a frame has consumed the events

 private:
  using Counts = std::array<int, kActions>;
  Counts down_{}, presses_{}, taps_{}, unfinished_{};
};

}  // namespace client
