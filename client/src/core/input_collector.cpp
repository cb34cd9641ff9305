#include "core/input_collector.h"

#include <algorithm>
#include <cmath>

namespace client {
namespace {

// A stick that exceeded this deflection and returned within a frame was flicked. Held beyond it,
// the stick steps through a menu.
constexpr float kFlicked = 0.5f;

float further(float a, float b) {
  return std::abs(a) >= std::abs(b) ? a : b;
}

int way(bool forward, bool back) {
  return (forward ? 1 : 0) - (back ? 1 : 0);
}

}  // namespace

void InputCollector::set_keys(const KeyBindings& keys) {
  bindings_ = keys;
  release_keys();
}

void InputCollector::key(int key, bool down) {
  if (down) any_key_ = key;
  if (down && key == key_of_name("Backspace")) text_ += '\b';
  if (down && (key == key_of_name("Enter") || key == key_of_name("KeypadEnter"))) text_ += '\r';
  if (down && key >= '0' && key <= '9') number_ = key == '0' ? 10 : key - '0';
  for (std::size_t action = 0; action < bindings_.size(); ++action) {
    for (std::size_t half = 0; half < halves_.size(); ++half) {
      if (bindings_[action][half] != key) continue;
      if (down) halves_[half].press(static_cast<Action>(action));
      if (!down) halves_[half].release(static_cast<Action>(action));
    }
  }
}

// Appends the letter as UTF-8.
void InputCollector::letter(std::uint32_t codepoint) {
  const auto put = [this](std::uint32_t byte) { text_ += static_cast<char>(byte); };
  const auto tail = [&](int shift) { put(0x80u | (codepoint >> shift & 0x3Fu)); };
  if (text_.size() > 256 || codepoint < 0x20 || codepoint > 0x10FFFF) return;
  if (codepoint < 0x80) return put(codepoint);
  if (codepoint < 0x800) {
    put(0xC0u | codepoint >> 6);
  } else if (codepoint < 0x10000) {
    put(0xE0u | codepoint >> 12);
    tail(6);
  } else {
    put(0xF0u | codepoint >> 18);
    tail(12);
    tail(6);
  }
  tail(0);
}

void InputCollector::release_keys() {
  for (ActionState& half : halves_) half.release_all();
}

void InputCollector::mouse_moved(double right, double forward) {
  mouse_right_ += right;
  mouse_forward_ += forward;
}

void InputCollector::connect(int pad, bool there) {
  if (pad < 0 || pad >= kPads) return;
  Pad& p = pads_[static_cast<std::size_t>(pad)];
  p.there = there;
  p.sticks = {};
  p.down = {};
}

void InputCollector::button(int pad, PadButton button, bool down) {
  if (pad < 0 || pad >= kPads) return;
  Pad& p = pads_[static_cast<std::size_t>(pad)];
  const auto i = static_cast<std::size_t>(button);
  p.presses[i] += down && !p.down[i] ? 1 : 0;
  p.down[i] = down;
}

void InputCollector::sticks(int pad, const cabinet::PadState& state) {
  if (pad < 0 || pad >= kPads) return;
  Pad& p = pads_[static_cast<std::size_t>(pad)];
  p.sticks = state;
  // The stick shoots to the right along the table: see player_input.cpp.
  p.flick = further(p.flick, state.right_x);
}

void InputCollector::take_keys(DeviceSet devices, InputEvents& events) const {
  const auto count = [&](Action action) {
    int presses = 0;
    for (std::size_t half = 0; half < halves_.size(); ++half)
      if ((devices & bit_of(half == 0 ? Device::keys_1 : Device::keys_2)) != 0)
        presses += halves_[half].presses(action);
    return presses;
  };
  for (int i = 0; i < kActions; ++i)
    events.presses[static_cast<std::size_t>(i)] = count(static_cast<Action>(i));
  double slide = 0.0, spin = 0.0;
  for (std::size_t half = 0; half < halves_.size(); ++half) {
    if ((devices & bit_of(half == 0 ? Device::keys_1 : Device::keys_2)) == 0) continue;
    const ActionState& keys = halves_[half];
    slide += keys.axis(Action::slide_away, Action::slide_near);
    spin += keys.axis(Action::spin_right, Action::spin_left);
    events.slide_taps += keys.tapped(Action::slide_away, Action::slide_near);
    events.spin_taps += keys.tapped(Action::spin_right, Action::spin_left);
  }
  events.key_slide = std::clamp(slide, -1.0, 1.0);
  events.key_spin = std::clamp(spin, -1.0, 1.0);
  for (int line = 0; line < 4; ++line) {
    if (count(static_cast<Action>(static_cast<int>(Action::rod_1) + line)) > 0)
      events.choose_line = line;
  }
  events.wheel += count(Action::next_rod) - count(Action::previous_rod);
  events.push = events.push || count(Action::push) > 0;
  events.toggle_automatic = count(Action::automatic) % 2 != 0;
  events.toggle_pause = count(Action::pause) % 2 != 0;
  events.toggle_help = count(Action::help) % 2 != 0;
}

void InputCollector::take_pad(const Pad& pad, InputEvents& events) const {
  const auto presses = [&](PadButton b) { return pad.presses[static_cast<std::size_t>(b)]; };
  const auto down = [&](PadButton b) { return pad.down[static_cast<std::size_t>(b)]; };
  events.has_pad = events.has_pad || pad.there;
  cabinet::PadState& sum = events.pad;
  sum.left_x = further(sum.left_x, pad.sticks.left_x);
  sum.left_y = further(sum.left_y, pad.sticks.left_y);
  sum.right_x = further(sum.right_x, pad.sticks.right_x);
  sum.right_y = further(sum.right_y, pad.sticks.right_y);
  if (std::abs(pad.flick) > kFlicked && std::abs(pad.sticks.right_x) < 0.5f * kFlicked)
    events.spin_taps += pad.flick > 0.0f ? 1 : -1;
  events.pad_push = events.pad_push || presses(PadButton::push) > 0;
  events.pad_pause = events.pad_pause || presses(PadButton::pause) % 2 != 0;
  events.pad_menu = events.pad_menu || presses(PadButton::menu) % 2 != 0;
  events.pad_back = events.pad_back || presses(PadButton::back) > 0;
  events.pad_share = events.pad_share || presses(PadButton::share) > 0;
  events.pad_time_out = events.pad_time_out || presses(PadButton::time_out) > 0;
  events.wheel += presses(PadButton::next_rod) - presses(PadButton::previous_rod);
  events.pad_up += presses(PadButton::up) - presses(PadButton::down);
  events.pad_right += presses(PadButton::right) - presses(PadButton::left);
  const auto stick = [](float value) { return way(value > kFlicked, value < -kFlicked); };
  const int up = way(down(PadButton::up), down(PadButton::down));
  const int right = way(down(PadButton::right), down(PadButton::left));
  if (up != 0 || stick(pad.sticks.left_y) != 0)
    events.held_up = up != 0 ? up : stick(pad.sticks.left_y);
  if (right != 0 || stick(pad.sticks.left_x) != 0)
    events.held_right = right != 0 ? right : stick(pad.sticks.left_x);
}

InputEvents InputCollector::take(DeviceSet devices) const {
  InputEvents events;
  if ((devices & bit_of(Device::mouse)) != 0) {
    events.mouse_right = mouse_right_;
    events.mouse_forward = mouse_forward_;
    events.wheel = static_cast<int>(wheel_);  // touch pads scroll in fractions of a step
    events.push = clicked_;
  }
  take_keys(devices, events);
  for (int pad = 0; pad < kPads; ++pad) {
    if ((devices & bit_of(pad_device(pad))) != 0)
      take_pad(pads_[static_cast<std::size_t>(pad)], events);
  }
  events.back = back_;
  events.any_key = any_key_;
  events.text = text_;
  if ((devices & bit_of(Device::keys_1)) != 0) events.number = number_;
  return events;
}

void InputCollector::clear() {
  for (ActionState& half : halves_) half.clear();
  for (Pad& pad : pads_) {
    pad.presses = {};
    pad.flick = 0.0f;
  }
  mouse_right_ = mouse_forward_ = 0.0;
  wheel_ -= std::trunc(wheel_);
  clicked_ = back_ = false;
  any_key_ = number_ = 0;
  text_.clear();
}

}  // namespace client
