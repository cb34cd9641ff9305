// What a person can do with keys, and how presses become axes. Keys are followed by their events,
// never by looking whether they are down at a frame: a tap that begins and ends between two frames
// counts as well. Knows no window library.
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
  feed,  // training: the next man of the rod in hand has the ball
};
inline constexpr int kActions = 23;

constexpr std::size_t index_of(Action action) {
  return static_cast<std::size_t>(action);
}

// Key presses between two frames. Several keys may stand for one action.
class ActionState {
 public:
  void press(Action action);
  void release(Action action);
  void release_all();  // the window lost the focus

  bool held(Action action) const { return down_[index_of(action)] > 0; }
  // Since the last clear(): how often it was pressed, and how many of these presses were over again
  // before it.
  int presses(Action action) const { return presses_[index_of(action)]; }
  int taps(Action action) const { return taps_[index_of(action)]; }
  // Of an axis between two actions: -1, 0, 1 as held; taps with their sign.
  double axis(Action forward, Action back) const;
  int tapped(Action forward, Action back) const { return taps(forward) - taps(back); }
  void clear();  // a frame has taken what happened

 private:
  using Counts = std::array<int, kActions>;
  Counts down_{}, presses_{}, taps_{}, unfinished_{};
};

}  // namespace client
