// Eight SPI motion sensors and the frame with their counts, the counterpart of MouseHost for PS/2
// mice.
//
// Each millisecond: sample(), add_to_frame(), then service() in the remaining time. service() sets
// up a sensor, or checks that all are still set up. A sensor with invalid answers counts as absent.
// Absent sensors are tried every kRetryMs. No SROM is uploaded: the sensors run their built-in
// program.
#ifndef FIRMWARE_CORE_SENSOR_HOST_H
#define FIRMWARE_CORE_SENSOR_HOST_H

#include <stdint.h>

#include "core/sensor_bus.h"
#include "wire/device_frame.h"

namespace firmware {

static_assert(kSensors == wire::kDeviceRods, "one sensor for each rod");

class SensorHost {
 public:
  explicit SensorHost(SensorBus& bus) : bus_(bus) {}

  // used: rods with such a sensor. resolution: [100 counts/inch], 1..120. Sets all sensors up
  // again.
  void begin(uint8_t used, uint8_t resolution);

  // Reads all sensors that are set up. elapsed_ms: since the last call, at least 1.
  void sample(uint8_t elapsed_ms);
  // One step of non-urgent work, at most 450 us.
  void service(uint32_t now_ms);

  // Adds these sensors' data to a frame whose other rods belong to others, and clears the events
  // since the last call.
  void add_to_frame(wire::DeviceFrame& frame);

  // Counts since power-on, wrapping.
  uint16_t slide(uint8_t sensor) const { return slide_[sensor]; }
  uint16_t spin(uint8_t sensor) const { return spin_[sensor]; }

  uint8_t present() const { return live_; }
  // The first setup attempt is complete, so present() is valid.
  bool tried() const { return tried_; }

  static constexpr uint16_t kRetryMs = 100;  // between attempts at absent sensors
  static constexpr uint8_t kWakeMs = 52;     // a sensor starts within 50 ms of a reset
  static constexpr uint8_t kCheckMs = 8;     // between identity checks
  // Product ID, inverse product ID, resolution: 24 ms for all.
  static constexpr uint8_t kQuestions = 3;

 private:
  enum Step : uint8_t { kIdle, kReset, kWake, kFlush, kRest, kResolution, kIdentity, kBurst };

  void set_up(uint32_t now_ms);
  // Runs the next check. suspicious: an answer was invalid as motion, which is an error by itself.
  void ask(bool suspicious);
  void lose(uint8_t sensors);
  void count_errors(uint8_t errors);

  SensorBus& bus_;
  uint8_t used_ = 0;
  uint8_t live_ = 0;
  uint8_t resolution_ = 20;
  // Sensors with an answer that is invalid as motion: all ones, or none of the sensor's processes
  // runs. They are checked at once.
  uint8_t suspect_ = 0;
  uint8_t observed_ = 0;  // sensors that have reported running processes

  Step step_ = kIdle;
  uint8_t setting_up_ = 0;  // sensors of the current step_
  uint8_t flushed_ = 0;     // registers read before the first valid motion
  uint32_t step_ms_ = 0;    // start time of step_
  uint32_t retry_ms_ = 0;
  uint32_t check_ms_ = 0;
  uint8_t question_ = 0;
  bool tried_ = false;

  uint16_t slide_[kSensors] = {};
  uint16_t spin_[kSensors] = {};
  bool set_up_again_ = false;
  uint8_t ever_live_ = 0;
  uint8_t overflow_ = 0;
  uint8_t quality_ = 0;
};

}  // namespace firmware

#endif
