// Eight SPI motion sensors and the frame made of them, as MouseHost does it for PS/2 mice.
//
// A millisecond is: sample(), make_frame(), then service() in the time that is left, which sets up
// a sensor or asks all whether they are still those that were set up. A sensor that answers
// nonsense is absent from then on; one that is absent is tried every kRetryMs. No vendor's program
// is uploaded: the sensors run the one they have.
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

  // used: rods that have such a sensor. resolution: [100 counts/inch], 1..120. All are set up anew.
  void begin(uint8_t used, uint8_t resolution);

  // Reads all that are set up; elapsed_ms since the last call, at least 1.
  void sample(uint8_t elapsed_ms);
  // One step of what is not urgent, at most 450 us.
  void service(uint32_t now_ms);

  // Adds what these sensors know to a frame of which the other rods are somebody else's, and
  // forgets what happened since the last call.
  void add_to_frame(wire::DeviceFrame& frame);

  // Counts since power-on, wrapping.
  uint16_t slide(uint8_t sensor) const { return slide_[sensor]; }
  uint16_t spin(uint8_t sensor) const { return spin_[sensor]; }

  uint8_t present() const { return live_; }
  // The first round of setting up is over: present() means something.
  bool tried() const { return tried_; }

  static constexpr uint16_t kRetryMs = 100;  // between attempts at absent sensors
  static constexpr uint8_t kWakeMs = 52;     // a sensor starts up within 50 ms of a reset
  static constexpr uint8_t kCheckMs = 8;     // between questions
  static constexpr uint8_t kQuestions = 3;   // product, inverse product, resolution: 24 ms for all

 private:
  enum Step : uint8_t { kIdle, kReset, kWake, kFlush, kRest, kResolution, kIdentity, kBurst };

  void set_up(uint32_t now_ms);
  // The next question; suspicious: an answer was no motion, which is an error by itself.
  void ask(bool suspicious);
  void lose(uint8_t sensors);
  void count_errors(uint8_t errors);

  SensorBus& bus_;
  uint8_t used_ = 0;
  uint8_t live_ = 0;
  uint8_t resolution_ = 20;
  // Answered what no motion is, all ones or that none of its processes runs: asked at once.
  uint8_t suspect_ = 0;
  uint8_t observed_ = 0;  // has said that its processes run

  Step step_ = kIdle;
  uint8_t setting_up_ = 0;  // those that step_ is about
  uint8_t flushed_ = 0;     // registers read before the first motion counts
  uint32_t step_ms_ = 0;    // when step_ began
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
