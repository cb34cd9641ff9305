// The sensors' bus on the pins of board.h: SPI mode 3, most significant bit first, bit-banged,
// since no peripheral reads eight data lines at the same time.
#ifndef FIRMWARE_RP2040_SENSOR_PINS_H
#define FIRMWARE_RP2040_SENSOR_PINS_H

#include "core/sensor_bus.h"

namespace rp2040 {

class SensorPins : public firmware::SensorBus {
 public:
  // used: rods with a sensor. Drives their select lines.
  void begin(uint8_t used);
  void burst(uint8_t selected, uint8_t* out) override;
  void read(uint8_t selected, uint8_t address, uint8_t* out) override;
  void write(uint8_t selected, uint8_t address, uint8_t value) override;

 private:
  void select(uint8_t selected);
  void release(uint8_t selected);
  void rest_since_register();

  uint32_t register_us_ = 0;  // end of the last register access
  uint8_t rest_us_ = 0;       // required delay before the next access
};

}  // namespace rp2040

#endif
