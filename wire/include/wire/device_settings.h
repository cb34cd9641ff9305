// The settings of the cabinet's micro-controller, and the report in which it tells them to the PC
// that asks (kind 5 of wire/device_command.h), in the place of one frame: freestanding C++14, as
// wire/device_frame.h, with the same CRC.
//
// Layout of the settings (little endian), kDeviceSettingsBytes in all, as the controller keeps them
// too; fields as in wire/device_command.h:
//   0  u8   version            kDeviceSettingsVersion
//   1  u8   resolution
//   2  u8   brightness
//   3  u8   ps2
//   4  u8   switches
//   5  u8   reserved           0
//   6  8 x { u16 travel, u16 turn }
//  38  u8   slide reversed     bit i: of rod i
//  39  u8   spin reversed      the same
// Layout of the report, kDeviceFrameBytes in all, packed as a frame is:
//   0  u8   kind               kDeviceSettingsReport, which is not a version of a frame
//   1  u8   abilities          of the board: bit 0: it has sensors, for which resolution and ps2
//                              are; bit 1: it can be gamepads
//   2  40 x u8                 the settings
//  42  u16  sequence           of the question
//  44  u16  crc                CRC-16/CCITT-FALSE over bytes 0..43
#ifndef WIRE_DEVICE_SETTINGS_H
#define WIRE_DEVICE_SETTINGS_H

#include "wire/device_command.h"

namespace wire {

static const uint8_t kDeviceSettingsVersion = 2;
static const uint8_t kDeviceSettingsBytes = 40;
static const uint8_t kDeviceSettingsReport = 0x81;
static const uint8_t kHasSensors = 1, kCanBeGamepads = 2;  // bits of abilities

struct StickScale {
  uint16_t travel = 0, turn = 0;  // counts; 0: from the table's dimensions
};

struct DeviceSettings {
  uint8_t resolution = 20;  // [100 counts/inch]: 78.7 counts/mm; 16 bits hold 0.4 m
  uint8_t brightness = 64;
  uint8_t ps2 = 0;
  uint8_t switches = 0;
  StickScale sticks[kDeviceRods];
  uint8_t slide_reversed = 0, spin_reversed = 0;
};

// out: kDeviceSettingsBytes.
inline void encode_device_settings(const DeviceSettings& settings, uint8_t* out) {
  out[0] = kDeviceSettingsVersion;
  out[1] = settings.resolution;
  out[2] = settings.brightness;
  out[3] = settings.ps2;
  out[4] = settings.switches;
  out[5] = 0;
  for (int rod = 0; rod < kDeviceRods; ++rod) {
    device_put16(out + 6 + 4 * rod, settings.sticks[rod].travel);
    device_put16(out + 8 + 4 * rod, settings.sticks[rod].turn);
  }
  out[38] = settings.slide_reversed;
  out[39] = settings.spin_reversed;
}

// Returns false, and leaves settings unchanged, unless version and ranges are valid. in:
// kDeviceSettingsBytes.
inline bool decode_device_settings(const uint8_t* in, DeviceSettings& settings) {
  if (in[0] != kDeviceSettingsVersion || in[5] != 0) return false;
  if (in[1] < 1 || in[1] > kMaxSensorResolution || in[4] > (kPulsesOff | kGamepads)) return false;
  DeviceSettings read;
  read.resolution = in[1];
  read.brightness = in[2];
  read.ps2 = in[3];
  read.switches = in[4];
  for (int rod = 0; rod < kDeviceRods; ++rod) {
    StickScale& stick = read.sticks[rod];
    stick.travel = device_get16(in + 6 + 4 * rod);
    stick.turn = device_get16(in + 8 + 4 * rod);
    if (!valid_stick_counts(stick.travel) || !valid_stick_counts(stick.turn)) return false;
  }
  read.slide_reversed = in[38];
  read.spin_reversed = in[39];
  settings = read;
  return true;
}

struct SettingsReport {
  DeviceSettings settings;
  uint8_t abilities = 0;
  uint16_t sequence = 0;
};

// out: kDeviceFrameBytes.
inline void encode_settings_report(const DeviceSettings& settings, uint8_t abilities,
                                   uint16_t sequence, uint8_t* out) {
  out[0] = kDeviceSettingsReport;
  out[1] = abilities;
  encode_device_settings(settings, out + 2);
  device_put16(out + 42, sequence);
  device_put16(out + 44, device_crc16(out, 44));
}

// True for a settings report of any version.
inline bool is_settings_report(const uint8_t* in, size_t size) {
  return size == kDeviceFrameBytes && in[0] == kDeviceSettingsReport &&
         device_get16(in + 44) == device_crc16(in, 44);
}

// Returns false, and leaves out unchanged, unless size, kind, version, CRC and all ranges are
// valid.
inline bool decode_settings_report(const uint8_t* in, size_t size, SettingsReport& out) {
  if (!is_settings_report(in, size) || in[1] > (kHasSensors | kCanBeGamepads)) return false;
  if (!decode_device_settings(in + 2, out.settings)) return false;
  out.abilities = in[1];
  out.sequence = device_get16(in + 42);
  return true;
}

}  // namespace wire

#endif
