// What a person did between two frames, without any window library's types.
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
  int number = 0;              // 1..10: this number key was pressed, 0 as the tenth
  int wheel = 0;               // steps, outwards positive
  double key_slide = 0.0;      // -1, 0, 1: away from the person positive, as held
  double key_spin = 0.0;       // -1, 0, 1: to the right positive, as held
  // Presses of these keys that were over before the frame, with their sign.
  int slide_taps = 0, spin_taps = 0;
  std::array<int, kActions> presses{};  // of keys, by Action
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
  bool pad_back = false;            // out of a menu or a screen
  bool pad_share = false;           // a recording; in training the next man
  int pad_up = 0, pad_right = 0;    // presses of its cross, with their sign
  int held_up = 0, held_right = 0;  // -1, 0, 1: cross or left stick of a pad, as held
  bool back = false;                // Esc, while the pointer is free
  int any_key = 0;                  // of the window library; 0: none was pressed
  std::string text{};               // typed: UTF-8, '\b' to take a letter back, '\r' for Enter
};

}  // namespace client
