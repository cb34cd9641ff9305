// Eight motion sensors of the PMW3360 class as the core sees them: clock and data to them shared,
// a select line and a data line from each of its own, so that all eight answer at the same time.
#ifndef FIRMWARE_CORE_SENSOR_BUS_H
#define FIRMWARE_CORE_SENSOR_BUS_H

#include <stdint.h>

namespace firmware {

static const uint8_t kSensors = 8;
static const uint8_t kBurstBytes = 6;  // motion, observation, x low and high, y low and high

// out[i]: bit i of each of the 8 rows, row 0 the most significant. rows and out: 8, 4-aligned.
void transpose8(const uint8_t* rows, uint8_t* out);

// The calls keep the times that the sensor asks for between them.
class SensorBus {
 public:
  // out[8 * byte + bit]: what the sensors answered in this bit, most significant first, sensor i in
  // bit i. Bits of sensors that are not selected mean nothing. out: 8 * kBurstBytes.
  virtual void burst(uint8_t selected, uint8_t* out) = 0;
  // The register of each selected sensor. out: kSensors, 4-aligned.
  virtual void read(uint8_t selected, uint8_t address, uint8_t* out) = 0;
  virtual void write(uint8_t selected, uint8_t address, uint8_t value) = 0;

 protected:
  ~SensorBus() = default;
};

}  // namespace firmware

#endif
