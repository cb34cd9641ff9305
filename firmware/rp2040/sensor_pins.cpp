#include "rp2040/sensor_pins.h"

#include "rp2040/board.h"
#include "rp2040/system.h"

namespace rp2040 {

namespace {

using firmware::kBurstBytes;
using firmware::kSensors;

// Timing of the PMW3360's datasheet.
constexpr uint32_t kReadDelayUs = 160;     // tSRAD: from address to data
constexpr uint32_t kBurstDelayUs = 35;     // tSRAD_MOTBR: the same for a burst
constexpr uint32_t kWriteHoldUs = 35;      // tSCLK-NCS for a write
constexpr uint8_t kAfterWriteUs = 180;     // tSWW, tSWR
constexpr uint8_t kAfterReadUs = 20;       // tSRW, tSRR
constexpr uint32_t kSelectCycles = 18;     // tNCS-SCLK: 120 ns
constexpr uint32_t kBurstExitCycles = 66;  // tBEXIT: 500 ns
// Half a period at 2 MHz is 31.25 cycles; the loop's instructions take the rest.
constexpr uint32_t kLowCycles = 30, kHighCycles = 27;

constexpr uint8_t kMotionBurst = 0x50, kWrite = 0x80;

inline __attribute__((always_inline)) void send(uint32_t value) {
#pragma GCC unroll 1
  for (uint32_t mask = 0x80; mask != 0; mask >>= 1) {
    reg(kGpioOutClear) = bit(kSensorClock);
    reg((value & mask) != 0 ? kGpioOutSet : kGpioOutClear) = bit(kSensorData);
    wait_cycles(kLowCycles);
    reg(kGpioOutSet) = bit(kSensorClock);
    wait_cycles(kHighCycles);
  }
}

// Reads the data lines before each rising edge: sensors change them at the falling edge.
inline __attribute__((always_inline)) void receive(uint8_t* rows, uint32_t count) {
#pragma GCC unroll 1
  for (uint32_t i = 0; i < count; ++i) {
    reg(kGpioOutClear) = bit(kSensorClock);
    wait_cycles(kLowCycles);
    const uint32_t lines = reg(kGpioIn);
    reg(kGpioOutSet) = bit(kSensorClock);
    rows[i] = static_cast<uint8_t>(lines >> kFirstData);
    wait_cycles(kHighCycles);
  }
}

}  // namespace

void SensorPins::begin(uint8_t used) {
  reg(kGpioOutSet) = static_cast<uint32_t>(used) << kFirstSelect;
  reg(kGpioOeSet) = static_cast<uint32_t>(used) << kFirstSelect;
}

void SensorPins::select(uint8_t selected) {
  reg(kGpioOutClear) = static_cast<uint32_t>(selected) << kFirstSelect;
  wait_cycles(kSelectCycles);
}

void SensorPins::release(uint8_t selected) {
  reg(kGpioOutSet) = static_cast<uint32_t>(selected) << kFirstSelect;
}

void SensorPins::rest_since_register() {
  if (rest_us_ != 0) sleep_until(register_us_ + rest_us_ + 1);
  rest_us_ = 0;
}

void SensorPins::burst(uint8_t selected, uint8_t* out) {
  rest_since_register();
  select(selected);
  send(kMotionBurst);
  wait_us(kBurstDelayUs);
  receive(out, 8 * kBurstBytes);
  release(selected);
  wait_cycles(kBurstExitCycles);
}

void SensorPins::read(uint8_t selected, uint8_t address, uint8_t* out) {
  rest_since_register();
  alignas(4) uint8_t rows[8];
  select(selected);
  send(address);
  wait_us(kReadDelayUs);
  receive(rows, 8);
  wait_cycles(kSelectCycles);
  release(selected);
  register_us_ = micros();
  rest_us_ = kAfterReadUs;
  firmware::transpose8(rows, out);
}

void SensorPins::write(uint8_t selected, uint8_t address, uint8_t value) {
  rest_since_register();
  select(selected);
  send(address | kWrite);
  send(value);
  wait_us(kWriteHoldUs);
  release(selected);
  register_us_ = micros();
  rest_us_ = kAfterWriteUs - kWriteHoldUs;
}

}  // namespace rp2040
