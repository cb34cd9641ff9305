// Maps the sensor counts of eight rods to four gamepads with two sticks: one gamepad per player,
// one stick per hand. docs/decisions/0065-gamepads.md gives the reasons.
//
// A stick follows its handle. Pushing the handle away from the person moves the stick up; the
// travel between the stops of the rod covers the full range of the axis. Turning clockwise, seen
// from the handle, moves the stick right, in proportion to the angle up to a quarter turn, and back
// to the centre at half a turn, so that the axis never jumps. A fast turn also presses a button.
//
// Counts alone do not determine the pose of a rod. Two rules correct it. At the end of its travel,
// the position is clamped while counts continue, as the rod stays at its stop. A rod that nobody
// holds hangs with its feet down, so that angle becomes the centre of the spin axis.
#ifndef FIRMWARE_CORE_GAMEPADS_H
#define FIRMWARE_CORE_GAMEPADS_H

#include <stdint.h>

#include "core/settings.h"
#include "core/usb_descriptors.h"

namespace firmware {

class Gamepads {
 public:
  // Time without a count that means a released rod: no hand is that still.
  static const uint16_t kLetGoMs = 2000;
  static const uint8_t kWindowMs = 16;  // a sixteenth of a turn within it, 25 rad/s, is a fast turn
  // Windows for which a button stays pressed: 64 ms, long enough for any game.
  static const uint8_t kWindowsHeld = 4;

  // Sets the scale of a rod's counts: from the settings, else from the table's dimensions and the
  // sensor's resolution. If the scale changes, the stick returns to its centre.
  void scale(uint8_t rod, const wire::DeviceSettings& settings, uint16_t counts_per_cm);

  // Updates a rod with its present counts, which wrap: at least once every 32767 counts. The first
  // call only sets the reference. now_ms wraps: at least once every 65 s.
  void move(uint8_t rod, uint16_t slide, uint16_t spin, uint16_t now_ms);

  // Returns the report for the host, kPadBytes at a fixed address, or null if it has not changed.
  // Little endian: i16 X, Y, Rx, Ry in -32767..32767, right and down positive; u16 buttons: bit 0 a
  // fast turn of the left rod, bit 1 of the right one.
  const uint8_t* report(uint8_t pad);
  // The last report, whether sent before or not.
  const uint8_t* last_report(uint8_t pad) const { return reports_[pad]; }

  // Rods of a player, whose own goal is to the left.
  static uint8_t left_rod(uint8_t pad);
  static uint8_t right_rod(uint8_t pad);

  // Makes all reports due again. Called four times a second, so that a newly listening host needs
  // no detection.
  void forget_host() { told_ = 0; }

  // Call if the rods may have moved since the last move(), by any amount.
  void begin();

 private:
  struct Stick {
    uint16_t travel, turn;               // [counts]; 0: not scaled yet
    uint32_t slide_factor, spin_factor;  // axis units per count, times 2^16
    uint16_t slide_before, spin_before;
    uint16_t at;     // from 0 at the near stop to travel
    uint16_t angle;  // from 0 where it hangs down to turn - 1
    uint16_t moved_ms;
    int16_t window_spin;
    uint8_t window_ms;
    uint8_t windows_held;
    bool slide_reversed, spin_reversed;
    bool begun;  // slide_before and spin_before are valid
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
