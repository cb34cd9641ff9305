#include "rp2040/ps2_pins.h"

namespace rp2040 {

uint8_t Ps2Pins::mice_ = 0;
uint32_t Ps2Pins::next_us_ = 0;

void Ps2Pins::begin(uint8_t mice) {
  hold_interrupts();
  mice_ = mice;
  const uint32_t lines = static_cast<uint32_t>(mice) << kFirstData | static_cast<uint32_t>(mice)
                                                                         << kFirstSelect;
  reg(kGpioOeClear) = lines;
  reg(kGpioOutClear) = lines;  // output level 0 when driven
  if (mice == 0) {
    clear_bits(kTimerInterruptEnable, bit(1));
  } else {
    next_us_ = micros() + firmware::kSampleUs;
    reg(kTimerAlarm1) = next_us_;
    set_bits(kTimerInterruptEnable, bit(1));
    reg(kNvicEnable) = bit(kIrqTimer1);
  }
  allow_interrupts();
}

void Ps2Pins::sample(firmware::Ps2Lines& lines) {
  reg(kTimerInterrupts) = bit(1);
  next_us_ += firmware::kSampleUs;
  // After an interruption, such as a write to flash, the alarm would be in the past.
  if (static_cast<int32_t>(next_us_ - micros()) < 2) next_us_ = micros() + 2;
  reg(kTimerAlarm1) = next_us_;
  // Lines without a mouse read as idle, high.
  const uint32_t others = static_cast<uint8_t>(~mice_);
  const uint32_t first = reg(kGpioIn);
  lines.count_sample();
  wait_cycles(30);  // rejects spikes shorter than a quarter of a microsecond
  const uint32_t second = reg(kGpioIn);
  lines.sample(static_cast<uint8_t>(first >> kFirstSelect | others),
               static_cast<uint8_t>(first >> kFirstData | others),
               static_cast<uint8_t>(second >> kFirstSelect | others),
               [](uint8_t low) { drive_data(low); });
}

void Ps2Pins::drive_data(uint8_t low) {
  reg(kGpioOeClear) = static_cast<uint32_t>(mice_ & ~low) << kFirstData;
  reg(kGpioOeSet) = static_cast<uint32_t>(mice_ & low) << kFirstData;
}

void Ps2Pins::drive_clock(uint8_t low) {
  reg(kGpioOeClear) = static_cast<uint32_t>(mice_ & ~low) << kFirstSelect;
  reg(kGpioOeSet) = static_cast<uint32_t>(mice_ & low) << kFirstSelect;
}

}  // namespace rp2040

namespace firmware {

// The polling loop does not nest these calls.
void hold_sampling() {
  rp2040::hold_interrupts();
}
void resume_sampling() {
  rp2040::allow_interrupts();
}
void drive_lines(uint8_t clock_low, uint8_t data_low) {
  rp2040::Ps2Pins::drive_data(data_low);
  rp2040::Ps2Pins::drive_clock(clock_low);
}

}  // namespace firmware
