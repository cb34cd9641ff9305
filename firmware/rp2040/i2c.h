// The RP2040's I2C 0 (datasheet 4.3) as the bus of haptic drivers and index marks, 400 kHz.
//
// A part that was cut off while it sent may hold the data line for up to nine clocks: before a
// transfer those are given by hand, a clock for each call of state(), and the bus is ended
// (UM10204, 3.1.16). A transfer that does not end is given up, and the controller is reset: both
// lines are let go.
#ifndef FIRMWARE_RP2040_I2C_H
#define FIRMWARE_RP2040_I2C_H

#include <stdint.h>

#include "core/haptics.h"

namespace rp2040 {

class I2c : public firmware::I2cReadBus {
 public:
  void start();
  void write(uint8_t address, const uint8_t* bytes, uint8_t size) override;
  void read(uint8_t address) override;
  uint8_t byte() override;
  State state() override;
  // The end of a transfer: that the polling loop wakes is all that is needed.
  void on_interrupt();

 private:
  enum Work : uint8_t { kNone, kFreeing, kTransferring };

  void begin(uint8_t address, uint8_t size);  // 0: reads one byte
  void set_up();
  void disable();
  void end(bool good);
  void begin_transfer();
  void watch_transfer();
  void give_clock();

  Work work_ = kNone;
  bool failed_ = false;
  uint8_t address_ = 0;
  uint8_t bytes_[2] = {};
  uint8_t size_ = 0;    // to be written; 0: one byte is read
  uint8_t clocks_ = 0;  // left of those that free the bus
  uint32_t began_us_ = 0;
};

}  // namespace rp2040

#endif
