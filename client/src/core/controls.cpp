#include "client/controls.h"

#include <algorithm>

namespace client {

void ActionState::press(Action action) {
  const std::size_t i = index_of(action);
  ++down_[i];
  ++presses_[i];
  ++unfinished_[i];
}

void ActionState::release(Action action) {
  const std::size_t i = index_of(action);
  if (down_[i] == 0) return;  // pressed before this window had the focus
  --down_[i];
  if (unfinished_[i] == 0) return;
  --unfinished_[i];
  ++taps_[i];
}

void ActionState::release_all() {
  down_ = {};
  unfinished_ = {};
}

double ActionState::axis(Action forward, Action back) const {
  return (held(forward) ? 1.0 : 0.0) - (held(back) ? 1.0 : 0.0);
}

void ActionState::clear() {
  presses_ = taps_ = unfinished_ = {};
}

}  // namespace client
