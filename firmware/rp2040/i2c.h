// The RP2040's I2C 0 (datasheet 4.3) as the bus of haptic drivers and index marks, 400 kHz.
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
  void aim(uint8_t address);
  void begun();

  bool busy_ = false;
  bool failed_ = false;
  uint32_t began_us_ = 0;
};

}  // namespace rp2040

#endif
