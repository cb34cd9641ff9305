#include "rp2040/system.h"

#include "rp2040/board.h"

namespace rp2040 {

namespace {

constexpr uint32_t kUsedPeripherals = kResetI2c0 | kResetIoBank0 | kResetPadsBank0 | kResetPllSys |
                                      kResetPllUsb | kResetPwm | kResetTimer | kResetUsb;
// In scratch 0 if scratch 1 holds the number of resets.
constexpr uint32_t kScratchMagic = 0x57444F47;

void start_crystal() {
  reg(kXosc) = 0xAA0;      // 1 to 15 MHz
  reg(kXoscStartup) = 47;  // unit 256 cycles: 1 ms
  reg(kXosc) = 0xFAB << 12 | 0xAA0;
  while ((reg(kXoscStatus) & bit(31)) == 0) {
  }
}

// Output: 12 MHz * feedback / (divide1 * divide2). The VCO, 12 MHz * feedback, must be within 750
// to 1600 MHz.
void start_pll(uint32_t base, uint32_t feedback, uint32_t divide1, uint32_t divide2) {
  constexpr uint32_t kPower = 0x04, kFeedback = 0x08, kDividers = 0x0C;
  reg(base) = 1;
  reg(base + kFeedback) = feedback;
  clear_bits(base + kPower, bit(0) | bit(5));  // the PLL and its VCO
  while ((reg(base) & bit(31)) == 0) {
  }
  reg(base + kDividers) = divide1 << 16 | divide2 << 12;
  clear_bits(base + kPower, bit(3));
}

void start_clocks() {
  reg(kClkRefCtrl) = 2;  // crystal
  while ((reg(kClkRefSelected) & bit(2)) == 0) {
  }
  reg(kClkSysCtrl) = 0;  // crystal, while the system PLL starts
  while ((reg(kClkSysSelected) & bit(0)) == 0) {
  }
  start_pll(kPllSys, 125, 6, 2);
  start_pll(kPllUsb, 100, 5, 5);
  reg(kClkSysCtrl) = 0 << 5;      // auxiliary source: the system PLL
  reg(kClkSysCtrl) = 0 << 5 | 1;  // then switch to the auxiliary source
  while ((reg(kClkSysSelected) & bit(1)) == 0) {
  }
  reg(kClkPeriCtrl) = bit(11);       // from the system clock
  reg(kClkUsbCtrl) = bit(11);        // from the USB PLL
  reg(kWatchdogTick) = bit(9) | 12;  // 1 us tick of timer and watchdog
}

void set_up_pin(unsigned pin, uint32_t function, bool pull_up) {
  reg(pad(pin)) = kPadInput | kPadSchmitt | kPadDrive4mA | (pull_up ? kPadPullUp : 0);
  reg(pin_ctrl(pin)) = function;
}

void start_pins() {
  for (unsigned i = 0; i < kRodPins; ++i) {
    // Pull-up: reads 1 where no sensor drives the line.
    set_up_pin(kFirstData + i, kFunctionSio, true);
    set_up_pin(kFirstSelect + i, kFunctionSio, true);
  }
  set_up_pin(kButton, kFunctionSio, true);
  set_up_pin(kI2cData, kFunctionI2c, true);
  set_up_pin(kI2cClock, kFunctionI2c, true);
  reg(kGpioOutSet) = bit(kSensorClock) | bit(kSensorData);  // clock idle high
  reg(kGpioOutClear) = bit(kMotorsEnable);
  const unsigned outputs[] = {kSensorClock, kSensorData, kMotorsEnable};
  for (const unsigned pin : outputs) {
    set_up_pin(pin, kFunctionSio, false);
    reg(kGpioOeSet) = bit(pin);
  }
  constexpr uint32_t kLedSlice = kPwm + 0x14 * ((kLed / 2) % 8);  // uses channel B: odd pins
  reg(kLedSlice + 0x04) = 16 << 4;                                // 125 MHz / 16 / 65025: 120 Hz
  reg(kLedSlice + 0x0C) = 0;
  reg(kLedSlice + 0x10) = 255 * 255 - 1;
  reg(kLedSlice) = 1;
  set_up_pin(kLed, kFunctionPwm, false);
}

}  // namespace

void reset_peripherals(uint32_t peripherals) {
  set_bits(kResets, peripherals);
  clear_bits(kResets, peripherals);
  while ((reg(kResetDone) & peripherals) != peripherals) {
  }
}

void start_system() {
  start_crystal();
  reset_peripherals(kUsedPeripherals);  // a boot loader may have left them running
  start_clocks();
  start_pins();
  reg(kTimerInterruptEnable) = bit(0);
  reg(kNvicEnable) = bit(kIrqTimer0);
}

void sleep_until(uint32_t at_us) {
  const volatile uint8_t none = 0;
  while (static_cast<int32_t>(micros() - at_us) < 0) sleep_until_event(at_us, none, 0);
}

void sleep_until_event(uint32_t at_us, const volatile uint8_t& events, uint8_t seen) {
  hold_interrupts();
  reg(kTimerAlarm0) = at_us;
  // An interrupt at this point ends the sleep at once and is served when interrupts are enabled.
  if (events == seen && static_cast<int32_t>(micros() - at_us) < 0) asm volatile("wfi");
  allow_interrupts();
}

void wait_us(uint32_t duration_us) {
  sleep_until(micros() + duration_us + 1);  // the current microsecond has already started
}

void start_watchdog() {
  // Resets everything except the two oscillators.
  reg(kPsmWatchdogSelect) = 0x1FFFC;
  feed_watchdog();
  set_bits(kWatchdogCtrl, bit(30));
}

void feed_watchdog(uint32_t for_us) {
  reg(kWatchdogLoad) = 2 * for_us;  // counts down twice per microsecond (erratum RP2040-E1)
}

uint32_t watchdog_resets() {
  static bool counted = false;
  if (reg(kWatchdogScratch0) != kScratchMagic) {
    reg(kWatchdogScratch0) = kScratchMagic;
    reg(kWatchdogScratch0 + 4) = 0;
  } else if (!counted && (reg(kWatchdogReason) & 3) != 0) {
    reg(kWatchdogScratch0 + 4) = reg(kWatchdogScratch0 + 4) + 1;
  }
  counted = true;
  return reg(kWatchdogScratch0 + 4);
}

// Boot ROM (datasheet 2.8.3): 14h holds the address of its function table, 18h that of a function
// that looks up an entry.
void* rom_function(char first, char second) {
  typedef void* (*Find)(const uint16_t*, uint32_t);
  uint32_t table_at = 0x14, find_at = 0x18;
  // Prevents a compiler warning about low addresses.
  asm volatile("" : "+r"(table_at), "+r"(find_at));
  const uint16_t* table = reinterpret_cast<const uint16_t*>(
      static_cast<uint32_t>(*reinterpret_cast<const uint16_t*>(table_at)));
  const Find find =
      reinterpret_cast<Find>(static_cast<uint32_t>(*reinterpret_cast<const uint16_t*>(find_at)));
  return find(table, static_cast<uint32_t>(first) | static_cast<uint32_t>(second) << 8);
}

void enter_boot_loader() {
  typedef void (*ResetToUsb)(uint32_t led, uint32_t disabled);
  reinterpret_cast<ResetToUsb>(rom_function('U', 'B'))(bit(kLed), 0);
  for (;;) {
  }
}

void set_led(uint8_t brightness) {
  constexpr uint32_t kCompare = kPwm + 0x14 * ((kLed / 2) % 8) + 0x0C;
  // The eye perceives the square root of the intensity, so squaring gives equal steps.
  reg(kCompare) = static_cast<uint32_t>(brightness) * brightness << 16;
}

bool button_pressed() {
  return (reg(kGpioIn) & bit(kButton)) == 0;
}

}  // namespace rp2040

// The alarm only wakes sleep_until().
extern "C" void timer0_interrupt() {
  rp2040::reg(rp2040::kTimerInterrupts) = rp2040::bit(0);
}
