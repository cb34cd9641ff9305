// Eight rods as four gamepads of two sticks, one gamepad for each player and one stick for each
// hand: how the counts of the sensors become sticks. docs/decisions/0065-gamepads.md says why.
//
// A stick does what its handle does. Pushed away from the person: the stick goes up, from one end
// of its way at one stop of the rod to the other end at the other. Turned clockwise, seen from the
// handle: to the right, in proportion to the angle up to a quarter turn, and back to the middle at
// half a turn, so that it jumps nowhere. A fast turn presses a button besides.
//
// Counts are not enough to know where a rod is, so two things set the stick right again: at the end
// of its travel it stays while the counts go on, as the rod does at its stop; and a rod that nobody
// holds hangs with its feet down, so there is the middle of the spin.
#ifndef FIRMWARE_CORE_GAMEPADS_H
#define FIRMWARE_CORE_GAMEPADS_H

#include <stdint.h>

#include "core/settings.h"
#include "core/usb_descriptors.h"

namespace firmware {

class Gamepads {
 public:
  static const uint16_t kLetGoMs = 2000;  // without a count: no hand holds as still as that
  static const uint8_t kWindowMs = 16;    // in which a sixteenth of a turn, 25 rad/s, is fast
  static const uint8_t kWindowsHeld = 4;  // of a button: 64 ms, which no game overlooks

  // What a rod's counts mean: as the settings say, else by the table's dimensions and the counts
  // that its sensor makes on a centimetre. If that is something else the stick goes to its middle.
  void scale(uint8_t rod, const wire::DeviceSettings& settings, uint16_t counts_per_cm);

  // The rod's counts now, which wrap; at least every 32767 of them. The first only begin. now_ms
  // wraps: at least every 65 s.
  void move(uint8_t rod, uint16_t slide, uint16_t spin, uint16_t now_ms);

  // What the host is to be told, kPadBytes which stay where they are; null: what it was told last.
  // Little endian: i16 X, Y, Rx, Ry, of -32767..32767, down and right positive; u16 buttons: bit 0
  // a fast turn of the left rod, bit 1 of the right one.
  const uint8_t* report(uint8_t pad);
  // The last of these, told before or not.
  const uint8_t* last_report(uint8_t pad) const { return reports_[pad]; }

  // Of a player, whose own goal is to the left.
  static uint8_t left_rod(uint8_t pad);
  static uint8_t right_rod(uint8_t pad);

  // All is told again: called four times a second, so that nobody needs to know when another host
  // listens.
  void forget_host() { told_ = 0; }

  // The rods may have been moved since the last move(), by any way.
  void begin();

 private:
  struct Stick {
    uint16_t travel, turn;               // counts; 0: not scaled yet
    uint32_t slide_factor, spin_factor;  // 2^16 of an axis' unit on a count
    uint16_t slide_before, spin_before;
    uint16_t at;     // 0 at the near stop .. travel
    uint16_t angle;  // 0 where it hangs .. turn - 1
    uint16_t moved_ms;
    int16_t window_spin;
    uint8_t window_ms;
    uint8_t windows_held;
    bool slide_reversed, spin_reversed;
    bool begun;  // the counts before are known
  };

  static void middle(Stick& stick);
  static void spin_by(Stick& stick, int16_t counts, uint16_t now_ms);
  static void look_for_fast_turn(Stick& stick, int16_t counts, uint16_t now_ms);
  static int16_t axis_of_slide(const Stick& stick);
  static int16_t axis_of_spin(const Stick& stick);

  Stick sticks_[wire::kDeviceRods] = {};
  uint8_t told_ = 0;  // bit i: the host has a report of gamepad i
  uint8_t reports_[kPads][kPadBytes] = {};
};

}  // namespace firmware

#endif
