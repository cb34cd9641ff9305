// The RP2040's I2C 0 (datasheet 4.3) as the bus of haptic drivers and index marks, 400 kHz.
//
// A device that was interrupted while sending may hold the data line low for up to nine clocks.
// Before a transfer they are given by software, one for each call of state(), followed by STOP
// (UM10204, 3.1.16). A transfer that does not end is aborted by a reset of the controller, which
// releases both lines.
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
  // Called at the end of a transfer. It only needs to wake the polling loop.
  void on_interrupt();

 private:
  enum Work : uint8_t { kNone, kFreeing, kTransferring };

  void begin(uint8_t address, uint8_t size);  // size 0: reads one byte
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
  uint8_t size_ = 0;    // bytes to write; 0: one byte is read
  uint8_t clocks_ = 0;  // remaining clocks to free the bus
  uint32_t began_us_ = 0;
};

}  // namespace rp2040

#endif
