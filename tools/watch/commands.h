// A person's commands while choosing or watching a recording, from any input device.
#pragma once

#include <glm/vec2.hpp>

#include "client/input_events.h"
#include "render/hud_replay.h"

namespace watch {

enum class Command : std::uint8_t {
  none,
  // watching
  play,  // or pause
  slower,
  faster,
  tick_back,
  tick_on,
  back,  // one second
  on,
  far_back,  // ten seconds
  far_on,
  previous_goal,
  next_goal,
  camera,
  side,
  hide,
  // both
  begin,
  end,
  keep,
  share,
  picture,
  keys,
  leave,
  // choosing
  up,
  down,
  page_up,
  page_down,
  confirm,
};

// A key of the window library (GLFW). choosing: the list is shown, otherwise a recording.
Command command_of_key(int key, bool shift, bool choosing);
Command command_of_button(client::ReplayButton button);
// From a gamepad's presses in a frame: one command per press. Calls take(Command).
template <class Take>
void commands_of_pad(const client::InputEvents& pad, bool choosing, bool paused, Take take);

// A mouse event.
struct PointerEvent {
  enum class Kind : std::uint8_t { press, move, release, wheel } kind{};
  glm::vec2 at{0.0f};  // [px] of the framebuffer
  float steps = 0.0f;  // of the wheel, positive away from the person
};

// --- implementation -----------------------------------------------------------------------------

template <class Take>
void commands_of_pad(const client::InputEvents& pad, bool choosing, bool paused, Take take) {
  const auto repeat = [&](int presses, Command positive, Command negative) {
    for (int i = 0; i < presses; ++i) take(positive);
    for (int i = 0; i > presses; --i) take(negative);
  };
  if (pad.pad_push) take(choosing ? Command::confirm : Command::play);
  if (pad.pad_pause) take(choosing ? Command::confirm : Command::play);
  if (pad.pad_menu) take(Command::keys);
  if (pad.pad_share) take(Command::share);
  if (pad.pad_time_out) take(choosing ? Command::keep : Command::camera);
  if (pad.pad_back) take(Command::leave);
  if (choosing) {
    repeat(pad.pad_up, Command::up, Command::down);
    repeat(pad.wheel, Command::page_down, Command::page_up);
    return;
  }
  repeat(pad.pad_up, Command::faster, Command::slower);
  repeat(pad.wheel, Command::next_goal, Command::previous_goal);
  repeat(pad.pad_right, paused ? Command::tick_on : Command::on,
         paused ? Command::tick_back : Command::back);
}

}  // namespace watch
