// Eight Hall switches, one a rod, at one expander of the PCF8574 class: its eight pins come in one
// byte, low where a magnet is near. It is on the bus itself, not behind the motors' multiplexer.
//
// Nothing waits: poll() moves one reading on, when the bus is free. An expander that does not
// answer is absent, as its marks are, and is tried again later.
#ifndef FIRMWARE_CORE_INDEX_MARKS_H
#define FIRMWARE_CORE_INDEX_MARKS_H

#include <stdint.h>

#include "core/haptics.h"

namespace firmware {

class IndexMarks {
 public:
  explicit IndexMarks(I2cReadBus& bus, uint8_t read_ms = 1) : bus_(bus), read_ms_(read_ms) {}

  // Once a millisecond, and until then if a reading may have ended.
  void poll(uint32_t now_ms);

  bool reading() const { return reading_; }
  // Bit i: the mark of rod i is under its switch, as of the last reading.
  uint8_t under() const { return under_; }

  static constexpr uint8_t kExpander = 0x20;
  static constexpr uint16_t kRetryMs = 1000;  // between readings of one that does not answer

 private:
  void reading_ended(bool good, uint32_t now_ms);

  I2cReadBus& bus_;
  const uint8_t read_ms_;  // between readings
  bool reading_ = false;
  uint8_t under_ = 0;
  uint32_t next_ms_ = 0;
};

}  // namespace firmware

#endif
