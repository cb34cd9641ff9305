// PS/2 mice on the pins of board.h: what core/sampling.h asks of a board, and the interrupt that
// samples all lines. The same core samples on the AVR; here it takes a twentieth of the processor,
// so that no PIO program is needed, and a bit that a mouse asks for is answered in the sample that
// sees its clock fall.
#ifndef FIRMWARE_RP2040_PS2_PINS_H
#define FIRMWARE_RP2040_PS2_PINS_H

#include <stdint.h>

#include "core/ps2_lines.h"
#include "rp2040/board.h"
#include "rp2040/system.h"

namespace rp2040 {

class Ps2Pins {
 public:
  // mice: rods that have one: their lines float from now on, and are sampled every kSampleUs.
  static void begin(uint8_t mice);
  // The interrupt of the timer's second alarm.
  static void sample(firmware::Ps2Lines& lines);
  static void drive_data(uint8_t low);
  static void drive_clock(uint8_t low);

 private:
  static uint8_t mice_;
  static uint32_t next_us_;
};

}  // namespace rp2040

#endif
