// PS/2 mice on the pins of board.h: implements core/sampling.h and the interrupt that samples all
// lines, with the same core as on the AVR. It takes a twentieth of the processor time, so no PIO
// program is needed. A bit that a mouse clocks out is driven in the sample that sees the clock
// fall.
#ifndef FIRMWARE_RP2040_PS2_PINS_H
#define FIRMWARE_RP2040_PS2_PINS_H

#include <stdint.h>

#include "core/ps2_lines.h"
#include "rp2040/board.h"
#include "rp2040/system.h"

namespace rp2040 {

class Ps2Pins {
 public:
  // mice: rods with a mouse. Releases their lines and samples them every kSampleUs.
  static void begin(uint8_t mice);
  // The interrupt of timer alarm 1.
  static void sample(firmware::Ps2Lines& lines);
  static void drive_data(uint8_t low);
  static void drive_clock(uint8_t low);

 private:
  static uint8_t mice_;
  static uint32_t next_us_;
};

}  // namespace rp2040

#endif
