// What is kept in a controller's flash or EEPROM:
//   0 u8 version, 1 u8 resolution, 2 u8 brightness, 3 u8 ps2, 4 u8 switches, 5 u8 0,
//   6 8 x { u16 travel, u16 turn }, 38 u8 slide reversed, 39 u8 spin reversed (bit i: of rod i),
//   40 u16 CRC
// fields and CRC as in wire/device_command.h. Version 1 has no sticks: 6 u16 CRC. It is read too.
#ifndef FIRMWARE_CORE_SETTINGS_H
#define FIRMWARE_CORE_SETTINGS_H

#include "wire/device_command.h"

namespace firmware {

static const uint8_t kSettingsVersion = 2;
static const uint8_t kSettingsBytes = 42;
static const uint8_t kSettingsBytes1 = 8;  // of version 1

struct StickScale {
  uint16_t travel = 0, turn = 0;  // counts; 0: by the table's dimensions
};

struct Settings {
  uint8_t resolution = 20;  // [100 counts/inch]: 78.7 counts/mm, which 16 bits hold for 0.4 m
  uint8_t brightness = 64;
  uint8_t ps2 = 0;
  uint8_t switches = 0;
  StickScale sticks[wire::kDeviceRods];
  uint8_t slide_reversed = 0, spin_reversed = 0;  // bit i: of rod i
};

// What a command of settings says, put into them; false: they were so.
inline bool take_settings(const wire::DeviceCommand& command, Settings& settings) {
  if (settings.resolution == command.resolution && settings.brightness == command.brightness &&
      settings.ps2 == command.ps2 && settings.switches == command.switches) {
    return false;
  }
  if (settings.resolution != command.resolution) {  // what was measured was counts of before
    for (StickScale& stick : settings.sticks) stick = StickScale();
    settings.slide_reversed = settings.spin_reversed = 0;
  }
  settings.resolution = command.resolution;
  settings.brightness = command.brightness;
  settings.ps2 = command.ps2;
  settings.switches = command.switches;
  return true;
}

// The same of a command for a rod's stick.
inline bool take_stick(const wire::DeviceCommand& command, Settings& settings) {
  const uint8_t bit = static_cast<uint8_t>(1u << command.rod);
  const auto marked = [bit](uint8_t mask, bool on) {
    return static_cast<uint8_t>(on ? mask | bit : mask & ~bit);
  };
  const uint8_t slide =
      marked(settings.slide_reversed, (command.reversed & wire::kSlideReversed) != 0);
  const uint8_t spin =
      marked(settings.spin_reversed, (command.reversed & wire::kSpinReversed) != 0);
  StickScale& stick = settings.sticks[command.rod];
  if (stick.travel == command.travel && stick.turn == command.turn &&
      settings.slide_reversed == slide && settings.spin_reversed == spin) {
    return false;
  }
  stick.travel = command.travel;
  stick.turn = command.turn;
  settings.slide_reversed = slide;
  settings.spin_reversed = spin;
  return true;
}

// out: kSettingsBytes.
inline void encode_settings(const Settings& settings, uint8_t* out) {
  out[0] = kSettingsVersion;
  out[1] = settings.resolution;
  out[2] = settings.brightness;
  out[3] = settings.ps2;
  out[4] = settings.switches;
  out[5] = 0;
  for (uint8_t rod = 0; rod < wire::kDeviceRods; ++rod) {
    wire::device_put16(out + 6 + 4 * rod, settings.sticks[rod].travel);
    wire::device_put16(out + 8 + 4 * rod, settings.sticks[rod].turn);
  }
  out[38] = settings.slide_reversed;
  out[39] = settings.spin_reversed;
  wire::device_put16(out + 40, wire::device_crc16(out, 40));
}

// False, and settings untouched, unless version, CRC and ranges hold. in: kSettingsBytes.
inline bool decode_settings(const uint8_t* in, Settings& settings) {
  if (in[0] < 1 || in[0] > kSettingsVersion || in[5] != 0) return false;
  const bool sticks = in[0] > 1;
  const uint8_t crc_at = static_cast<uint8_t>((sticks ? kSettingsBytes : kSettingsBytes1) - 2);
  if (wire::device_get16(in + crc_at) != wire::device_crc16(in, crc_at)) return false;
  const uint8_t most_switches = sticks ? wire::kPulsesOff | wire::kGamepads : wire::kPulsesOff;
  if (in[1] < 1 || in[1] > wire::kMaxSensorResolution || in[4] > most_switches) return false;
  Settings read;
  read.resolution = in[1];
  read.brightness = in[2];
  read.ps2 = in[3];
  read.switches = in[4];
  for (uint8_t rod = 0; sticks && rod < wire::kDeviceRods; ++rod) {
    StickScale& stick = read.sticks[rod];
    stick.travel = wire::device_get16(in + 6 + 4 * rod);
    stick.turn = wire::device_get16(in + 8 + 4 * rod);
    if (!wire::valid_stick_counts(stick.travel) || !wire::valid_stick_counts(stick.turn))
      return false;
  }
  if (sticks) {
    read.slide_reversed = in[38];
    read.spin_reversed = in[39];
  }
  settings = read;
  return true;
}

}  // namespace firmware

#endif
