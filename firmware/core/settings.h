// The settings (wire/device_settings.h): how commands change them, and their format in a
// controller's flash or EEPROM: the encoded settings, then a u16 CRC. Version 1 can be read too. It
// has no sticks: its CRC follows byte 5.
#ifndef FIRMWARE_CORE_SETTINGS_H
#define FIRMWARE_CORE_SETTINGS_H

#include "wire/device_settings.h"

namespace firmware {

static const uint8_t kKeptBytes = wire::kDeviceSettingsBytes + 2;

// Applies a settings command. False: nothing changed.
inline bool take_settings(const wire::DeviceCommand& command, wire::DeviceSettings& settings) {
  if (settings.resolution == command.resolution && settings.brightness == command.brightness &&
      settings.ps2 == command.ps2 && settings.switches == command.switches) {
    return false;
  }
  // Measured values are in counts of the old resolution.
  if (settings.resolution != command.resolution) {
    for (wire::StickScale& stick : settings.sticks) stick = wire::StickScale();
    settings.slide_reversed = settings.spin_reversed = 0;
  }
  settings.resolution = command.resolution;
  settings.brightness = command.brightness;
  settings.ps2 = command.ps2;
  settings.switches = command.switches;
  return true;
}

// Applies a command for a rod's stick. False: nothing changed.
inline bool take_stick(const wire::DeviceCommand& command, wire::DeviceSettings& settings) {
  const uint8_t bit = static_cast<uint8_t>(1u << command.rod);
  const auto marked = [bit](uint8_t mask, bool on) {
    return static_cast<uint8_t>(on ? mask | bit : mask & ~bit);
  };
  const uint8_t slide =
      marked(settings.slide_reversed, (command.reversed & wire::kSlideReversed) != 0);
  const uint8_t spin =
      marked(settings.spin_reversed, (command.reversed & wire::kSpinReversed) != 0);
  wire::StickScale& stick = settings.sticks[command.rod];
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

// out: kKeptBytes.
inline void encode_kept(const wire::DeviceSettings& settings, uint8_t* out) {
  wire::encode_device_settings(settings, out);
  const uint16_t crc = wire::device_crc16(out, wire::kDeviceSettingsBytes);
  wire::device_put16(out + wire::kDeviceSettingsBytes, crc);
}

// False, with settings unchanged, if version, CRC or ranges are invalid. in: kKeptBytes.
inline bool decode_kept(const uint8_t* in, wire::DeviceSettings& settings) {
  const uint8_t size = in[0] == 1 ? 6 : wire::kDeviceSettingsBytes;
  if (wire::device_get16(in + size) != wire::device_crc16(in, size)) return false;
  if (in[0] != 1) return wire::decode_device_settings(in, settings);
  if (in[4] > wire::kPulsesOff) return false;
  uint8_t now[wire::kDeviceSettingsBytes] = {};
  now[0] = wire::kDeviceSettingsVersion;
  for (uint8_t at = 1; at < size; ++at) now[at] = in[at];
  return wire::decode_device_settings(now, settings);
}

}  // namespace firmware

#endif
