// What is kept in a controller's flash or EEPROM:
//   0 u8 version, 1 u8 resolution, 2 u8 brightness, 3 u8 ps2, 4 u8 switches, 5 u8 0, 6 u16 CRC
// fields and CRC as in wire/device_command.h.
#ifndef FIRMWARE_CORE_SETTINGS_H
#define FIRMWARE_CORE_SETTINGS_H

#include "wire/device_command.h"

namespace firmware {

static const uint8_t kSettingsVersion = 1;
static const uint8_t kSettingsBytes = 8;
static const uint8_t kPulsesOff = 1;  // in switches

struct Settings {
  uint8_t resolution = 20;  // [100 counts/inch]: 78.7 counts/mm, which 16 bits hold for 0.4 m
  uint8_t brightness = 64;
  uint8_t ps2 = 0;
  uint8_t switches = 0;
};

inline bool same(const Settings& a, const Settings& b) {
  return a.resolution == b.resolution && a.brightness == b.brightness && a.ps2 == b.ps2 &&
         a.switches == b.switches;
}

inline Settings settings_of(const wire::DeviceCommand& command) {
  Settings settings;
  settings.resolution = command.resolution;
  settings.brightness = command.brightness;
  settings.ps2 = command.ps2;
  settings.switches = command.switches;
  return settings;
}

// out: kSettingsBytes.
inline void encode_settings(const Settings& settings, uint8_t* out) {
  out[0] = kSettingsVersion;
  out[1] = settings.resolution;
  out[2] = settings.brightness;
  out[3] = settings.ps2;
  out[4] = settings.switches;
  out[5] = 0;
  wire::device_put16(out + 6, wire::device_crc16(out, 6));
}

// False, and settings untouched, unless version, CRC and ranges hold. in: kSettingsBytes.
inline bool decode_settings(const uint8_t* in, Settings& settings) {
  if (in[0] != kSettingsVersion || in[5] != 0) return false;
  if (wire::device_get16(in + 6) != wire::device_crc16(in, 6)) return false;
  if (in[1] < 1 || in[1] > wire::kMaxSensorResolution || in[4] > 1) return false;
  settings.resolution = in[1];
  settings.brightness = in[2];
  settings.ps2 = in[3];
  settings.switches = in[4];
  return true;
}

}  // namespace firmware

#endif
