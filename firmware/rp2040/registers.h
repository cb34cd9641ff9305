// The registers of the RP2040 that this firmware uses, named as in its datasheet (sections 2.2, 2.9
// to 2.19, 4.1 to 4.10). Each peripheral on APB and AHB has three aliases for atomic access to
// single bits: writing 1s at + 0x1000 toggles them, at + 0x2000 sets them, at + 0x3000 clears them.
#ifndef FIRMWARE_RP2040_REGISTERS_H
#define FIRMWARE_RP2040_REGISTERS_H

#include <stdint.h>

namespace rp2040 {

inline volatile uint32_t& reg(uint32_t address) {
  return *reinterpret_cast<volatile uint32_t*>(address);
}
inline void set_bits(uint32_t address, uint32_t bits) {
  reg(address + 0x2000) = bits;
}
inline void clear_bits(uint32_t address, uint32_t bits) {
  reg(address + 0x3000) = bits;
}
constexpr uint32_t bit(unsigned n) {
  return uint32_t{1} << n;
}

// ---- 4.10 the flash's SSI, and its cache
constexpr uint32_t kFlash = 0x10000000;
constexpr uint32_t kSsi = 0x18000000;
constexpr uint32_t kSsiCtrlr0 = kSsi + 0x00, kSsiCtrlr1 = kSsi + 0x04, kSsiEnable = kSsi + 0x08,
                   kSsiSlave = kSsi + 0x10, kSsiBaud = kSsi + 0x14, kSsiStatus = kSsi + 0x28,
                   kSsiData = kSsi + 0x60, kSsiSpiCtrlr0 = kSsi + 0xF4;

// ---- 2.14 resets
constexpr uint32_t kResets = 0x4000C000, kResetDone = kResets + 0x08;
constexpr uint32_t kResetI2c0 = bit(3), kResetIoBank0 = bit(5), kResetPadsBank0 = bit(8),
                   kResetPllSys = bit(12), kResetPllUsb = bit(13), kResetPwm = bit(14),
                   kResetTimer = bit(21), kResetUsb = bit(24);
constexpr uint32_t kPsmWatchdogSelect = 0x40010008;

// ---- 2.15 to 2.18 clocks
constexpr uint32_t kClocks = 0x40008000;
constexpr uint32_t kClkRefCtrl = kClocks + 0x30, kClkRefSelected = kClocks + 0x38,
                   kClkSysCtrl = kClocks + 0x3C, kClkSysSelected = kClocks + 0x44,
                   kClkPeriCtrl = kClocks + 0x48, kClkUsbCtrl = kClocks + 0x54;
constexpr uint32_t kXosc = 0x40024000, kXoscStatus = kXosc + 0x04, kXoscStartup = kXosc + 0x0C;
constexpr uint32_t kPllSys = 0x40028000, kPllUsb = 0x4002C000;

// ---- 2.19 pins
constexpr uint32_t kIoBank0 = 0x40014000, kPadsBank0 = 0x4001C000;
constexpr uint32_t kQspiSelectCtrl = 0x4001800C;
constexpr uint32_t pin_ctrl(unsigned pin) {
  return kIoBank0 + 8 * pin + 4;
}
constexpr uint32_t pad(unsigned pin) {
  return kPadsBank0 + 4 + 4 * pin;
}
constexpr uint32_t kPadPullUp = bit(3), kPadSchmitt = bit(1), kPadDrive4mA = 1 << 4,
                   kPadInput = bit(6);
constexpr uint32_t kFunctionI2c = 3, kFunctionPwm = 4, kFunctionSio = 5;

// ---- 2.3.1 single-cycle IO
constexpr uint32_t kSio = 0xD0000000;
constexpr uint32_t kGpioIn = kSio + 0x04, kGpioOutSet = kSio + 0x14, kGpioOutClear = kSio + 0x18,
                   kGpioOe = kSio + 0x20, kGpioOeSet = kSio + 0x24, kGpioOeClear = kSio + 0x28;

// ---- 4.3 I2C
constexpr uint32_t kI2c0 = 0x40044000;

// ---- 4.5 PWM
constexpr uint32_t kPwm = 0x40050000;

// ---- 4.6 timer, 4.7 watchdog
constexpr uint32_t kTimer = 0x40054000;
constexpr uint32_t kTimerAlarm0 = kTimer + 0x10, kTimerAlarm1 = kTimer + 0x14,
                   kTimerLow = kTimer + 0x28, kTimerInterrupts = kTimer + 0x34,
                   kTimerInterruptEnable = kTimer + 0x38;
constexpr uint32_t kWatchdog = 0x40058000;
constexpr uint32_t kWatchdogCtrl = kWatchdog, kWatchdogLoad = kWatchdog + 0x04,
                   kWatchdogReason = kWatchdog + 0x08, kWatchdogScratch0 = kWatchdog + 0x0C,
                   kWatchdogTick = kWatchdog + 0x2C;

// ---- 4.1 USB
constexpr uint32_t kUsbMemory = 0x50100000, kUsb = 0x50110000;
constexpr uint32_t kUsbAddress = kUsb, kUsbMainCtrl = kUsb + 0x40, kUsbSieCtrl = kUsb + 0x4C,
                   kUsbSieStatus = kUsb + 0x50, kUsbBuffStatus = kUsb + 0x58,
                   kUsbAbort = kUsb + 0x60, kUsbAbortDone = kUsb + 0x64, kUsbStallArm = kUsb + 0x68,
                   kUsbMuxing = kUsb + 0x74, kUsbPower = kUsb + 0x78,
                   kUsbInterruptEnable = kUsb + 0x90;

// ---- 2.4 the core's own
constexpr uint32_t kNvicEnable = 0xE000E100, kNvicDisable = 0xE000E180, kVectorTable = 0xE000ED08;
constexpr unsigned kIrqTimer0 = 0, kIrqTimer1 = 1, kIrqUsb = 5, kIrqI2c0 = 23;

}  // namespace rp2040

#endif
