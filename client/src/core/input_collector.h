// Collects the events of keys, mouse and gamepads between two frames, by device, so that several
// people can play at one window, each with separate devices. Presses are counted as they happen:
// one that ends before the frame counts too. Independent of the window library.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "client/devices.h"
#include "client/input_events.h"
#include "client/settings.h"

namespace client {

enum class PadButton : std::uint8_t {
  push,
  pause,
  menu,
  time_out,
  back,
  share,
  previous_rod,
  next_rod,
  up,
  down,
  left,
  right,
};
inline constexpr int kPadButtons = 12;

class InputCollector {
 public:
  void set_keys(const KeyBindings& keys);
  void key(int key, bool down);
  void release_keys();  // the window lost the focus
  void letter(std::uint32_t codepoint);
  void mouse_moved(double right, double forward);
  void click() { clicked_ = true; }
  void wheel(double steps) { wheel_ += steps; }
  void back() { back_ = true; }

  // pad: 0 .. kPads - 1; others are ignored.
  void connect(int pad, bool there);  // unplugged: its sticks return to zero
  bool connected(int pad) const { return pads_[static_cast<std::size_t>(pad)].there; }
  void button(int pad, PadButton button, bool down);
  void sticks(int pad, const cabinet::PadState& state);  // up positive; no shoulder buttons

  // The events of these devices since the last clear().
  InputEvents take(DeviceSet devices) const;
  void clear();  // a frame has consumed the events

 private:
  struct Pad {
    bool there = false;
    cabinet::PadState sticks;
    std::array<int, kPadButtons> presses{};
    std::array<bool, kPadButtons> down{};
    float flick = 0.0f;  // largest deflection of the right stick up or down since the last frame
  };
  void take_keys(DeviceSet devices, InputEvents& events) const;
  void take_pad(const Pad& pad, InputEvents& events) const;

  KeyBindings bindings_ = default_keys();
  std::array<ActionState, 2> halves_;  // by the first and the second key of each action
  std::array<Pad, kPads> pads_;
  double mouse_right_ = 0.0, mouse_forward_ = 0.0, wheel_ = 0.0;
  bool clicked_ = false, back_ = false;
  int any_key_ = 0, number_ = 0;
  std::string text_;
};

}  // namespace client
