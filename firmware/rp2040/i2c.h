// The RP2040's I2C 0 (datasheet 4.3) as the haptic drivers' bus, 400 kHz.
//
// A part that was cut off while it sent may hold the data line for up to nine clocks: before a
// write those are given by hand, a clock for each call of state(), and the bus is ended (UM10204,
// 3.1.16). A write that does not end is given up, and the controller is reset: both lines are let
// go.
#ifndef FIRMWARE_RP2040_I2C_H
#define FIRMWARE_RP2040_I2C_H

#include <stdint.h>

#include "core/haptics.h"

namespace rp2040 {

class I2c : public firmware::I2cBus {
 public:
  void start();
  void write(uint8_t address, const uint8_t* bytes, uint8_t size) override;
  State state() override;
  // The end of a write: that the polling loop wakes is all that is needed.
  void on_interrupt();

 private:
  enum Work : uint8_t { kNone, kFreeing, kWriting };

  void set_up();
  void disable();
  void end(bool good);
  void begin_write();
  void watch_write();
  void give_clock();

  Work work_ = kNone;
  bool failed_ = false;
  uint8_t address_ = 0;
  uint8_t bytes_[2] = {};
  uint8_t size_ = 0;
  uint8_t clocks_ = 0;  // left of those that free the bus
  uint32_t began_us_ = 0;
};

}  // namespace rp2040

#endif
