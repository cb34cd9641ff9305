// What a person did between two frames, in types that depend on no window library.
#pragma once

#include <array>
#include <string>

#include "cabinet/hand.h"
#include "client/controls.h"

namespace client {

struct InputEvents {
  double mouse_right = 0.0;    // [px], only while the pointer is captured
  double mouse_forward = 0.0;  // [px], away from the person
  int choose_line = -1;        // 0..3: a key for that line was pressed
  int number = 0;              // 1..10: this number key was pressed; the key 0 counts as 10
  int wheel = 0;               // steps, positive away from the person
  double key_slide = 0.0;      // -1, 0, 1 while held; positive away from the person
  double key_spin = 0.0;       // -1, 0, 1 while held; positive to the right
  // Signed number of presses of these keys that ended before the frame.
  int slide_taps = 0, spin_taps = 0;
  std::array<int, kActions> presses{};  // number of key presses, by Action
  bool toggle_automatic = false;
  bool toggle_pause = false;
  bool toggle_help = false;
  bool push = false;  // click, Space or Enter
  bool has_pad = false;
  cabinet::PadState pad;
  bool pad_push = false;
  bool pad_pause = false;
  bool pad_menu = false;
  bool pad_time_out = false;
  bool pad_back = false;            // leave a menu or a screen
  bool pad_share = false;           // share a recording; in training: next man
  int pad_up = 0, pad_right = 0;    // signed number of presses of the D-pad
  int held_up = 0, held_right = 0;  // -1, 0, 1 while held: D-pad or left stick of a pad
  bool back = false;                // Esc, while the pointer is free
  int any_key = 0;                  // key code of the window library; 0: none was pressed
  std::string text{};               // typed text: UTF-8, '\b' deletes a letter, '\r' for Enter
};

}  // namespace client
