// The bus of eight motion sensors of the PMW3360 class. They share the clock and the data line to
// the sensors. Each has its own select line and data line from the sensor, so that all eight answer
// at the same time.
#ifndef FIRMWARE_CORE_SENSOR_BUS_H
#define FIRMWARE_CORE_SENSOR_BUS_H

#include <stdint.h>

namespace firmware {

static const uint8_t kSensors = 8;
static const uint8_t kBurstBytes = 6;  // motion, observation, x low, x high, y low, y high

// out[i]: bit i of each of the 8 rows, row 0 in the most significant bit. rows, out: 8 bytes,
// 4-aligned.
void transpose8(const uint8_t* rows, uint8_t* out);

// The functions keep the sensor's required delays between accesses.
class SensorBus {
 public:
  // out[8 * byte + bit]: this bit of all sensors' answers, most significant bit first, sensor i in
  // bit i. Bits of unselected sensors are undefined. out: 8 * kBurstBytes.
  virtual void burst(uint8_t selected, uint8_t* out) = 0;
  // Reads the register of each selected sensor. out: kSensors bytes, 4-aligned.
  virtual void read(uint8_t selected, uint8_t address, uint8_t* out) = 0;
  virtual void write(uint8_t selected, uint8_t address, uint8_t value) = 0;

 protected:
  ~SensorBus() = default;
};

}  // namespace firmware

#endif
