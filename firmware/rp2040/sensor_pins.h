// The sensors' bus on the pins of board.h: mode 3, most significant bit first, driven by the
// program, since no peripheral takes in eight data lines at the same time.
#ifndef FIRMWARE_RP2040_SENSOR_PINS_H
#define FIRMWARE_RP2040_SENSOR_PINS_H

#include "core/sensor_bus.h"

namespace rp2040 {

class SensorPins : public firmware::SensorBus {
 public:
  // used: rods that have a sensor: their select lines are driven.
  void begin(uint8_t used);
  void burst(uint8_t selected, uint8_t* out) override;
  void read(uint8_t selected, uint8_t address, uint8_t* out) override;
  void write(uint8_t selected, uint8_t address, uint8_t value) override;

 private:
  void select(uint8_t selected);
  void release(uint8_t selected);
  void rest_since_register();

  uint32_t register_us_ = 0;  // when the last access to a register ended
  uint8_t rest_us_ = 0;       // before the next may begin
};

}  // namespace rp2040

#endif
