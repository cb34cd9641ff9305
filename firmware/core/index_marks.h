// Eight Hall switches, one per rod, on an expander of the PCF8574 class. One byte holds its eight
// pins; a pin is low while a magnet is near. The expander is directly on the bus, not behind the
// motors' multiplexer.
//
// Nothing blocks: poll() advances one read when the bus is free. An expander that does not answer
// counts as absent, as do its marks, and is tried again later.
#ifndef FIRMWARE_CORE_INDEX_MARKS_H
#define FIRMWARE_CORE_INDEX_MARKS_H

#include <stdint.h>

#include "core/haptics.h"

namespace firmware {

class IndexMarks {
 public:
  explicit IndexMarks(I2cReadBus& bus, uint8_t read_ms = 1) : bus_(bus), read_ms_(read_ms) {}

  // Call once a millisecond, and also when a read may have ended.
  void poll(uint32_t now_ms);

  bool reading() const { return reading_; }
  // Bit i: the mark of rod i is under its switch, as of the last read.
  uint8_t under() const { return under_; }

  static constexpr uint8_t kExpander = 0x20;
  static constexpr uint16_t kRetryMs = 1000;  // between attempts at an absent expander

 private:
  void reading_ended(bool good, uint32_t now_ms);

  I2cReadBus& bus_;
  const uint8_t read_ms_;  // between reads
  bool reading_ = false;
  uint8_t under_ = 0;
  uint32_t next_ms_ = 0;
};

}  // namespace firmware

#endif
