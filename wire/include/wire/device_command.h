// The command from the PC to the cabinet's micro-controller, shared by both: freestanding C++14, as
// wire/device_frame.h, with the same CRC.
//
// Layout (little endian), kDeviceCommandBytes in all:
//   0  u8   version            kDeviceCommandVersion
//   1  u8   kind               1 pulse, 2 all off, 3 settings, 4 stick, 5 tell the settings
//                              (wire/device_settings.h)
//   2  u16  sequence           of the sender, wraps; not checked
//   4  u8   rod                pulse, stick: 0..7
//   5  u8   amplitude          pulse: 0..255, as a fraction of the motor's full power
//      u8   reversed           stick: bit 0: pushed away from the person slide counts fall;
//                              bit 1: turned clockwise, seen from the handle, spin counts fall
//   6  u16  duration           pulse: 1..kMaxPulseMs [ms]
//   8  u8   resolution         settings: of the sensors, 1..120 [100 counts/inch]
//   9  u8   brightness         settings: of the LED, 0..255
//  10  u8   ps2                settings: bit i: rod i has a PS/2 mouse
//  11  u8   switches           settings: bit 0: no pulse is played; bit 1: the rods are also
//                              gamepads, with a controller that has a USB of its own
//   8  u16  travel             stick: slide counts from stop to stop, kMinStickCounts or more;
//                              0: by the table's dimensions
//  10  u16  turn               stick: spin counts of a whole turn, within the same bounds
//  12  u16  reserved           0
//  14  u16  crc                CRC-16/CCITT-FALSE over bytes 0..13
// Fields that a kind does not use are 0. Over USB HID: the first bytes of one 64-byte output
// report, the others 0. Over a serial line: COBS, then a 0.
#ifndef WIRE_DEVICE_COMMAND_H
#define WIRE_DEVICE_COMMAND_H

#include "wire/device_frame.h"

namespace wire {

static const uint8_t kDeviceCommandVersion = 1;
static const size_t kDeviceCommandBytes = 16;
static const uint16_t kMaxPulseMs = 250;          // the motor stops by then without another command
static const uint8_t kMaxSensorResolution = 120;  // 12000 counts/inch, the maximum of a PMW3360
static const uint16_t kMinStickCounts = 64;       // fewer are hand tremor, not travel
static const uint8_t kPulsesOff = 1, kGamepads = 2;          // bits of switches
static const uint8_t kSlideReversed = 1, kSpinReversed = 2;  // bits of reversed

enum DeviceCommandKind : uint8_t {
  kPulseCommand = 1,
  kAllOffCommand = 2,
  kSettingsCommand = 3,
  kStickCommand = 4,
  kTellSettingsCommand = 5,
};

struct DeviceCommand {
  uint8_t kind;
  uint16_t sequence;
  uint8_t rod, amplitude;
  uint16_t duration_ms;
  uint8_t resolution, brightness, ps2, switches;
  uint16_t travel, turn;  // counts
  uint8_t reversed;
};

inline bool valid_stick_counts(uint16_t counts) {
  return counts == 0 || counts >= kMinStickCounts;
}

inline bool valid_device_command(const DeviceCommand& c) {
  const bool no_pulse = c.amplitude == 0 && c.duration_ms == 0;
  const bool no_settings = c.resolution == 0 && c.brightness == 0 && c.ps2 == 0 && c.switches == 0;
  const bool no_stick = c.travel == 0 && c.turn == 0 && c.reversed == 0;
  switch (c.kind) {
    case kPulseCommand:
      return no_settings && no_stick && c.rod < kDeviceRods && c.duration_ms >= 1 &&
             c.duration_ms <= kMaxPulseMs;
    case kAllOffCommand:
    case kTellSettingsCommand:
      return no_pulse && no_settings && no_stick && c.rod == 0;
    case kSettingsCommand:
      return no_pulse && no_stick && c.rod == 0 && c.resolution >= 1 &&
             c.resolution <= kMaxSensorResolution && c.switches <= (kPulsesOff | kGamepads);
    case kStickCommand:
      return no_pulse && no_settings && c.rod < kDeviceRods && valid_stick_counts(c.travel) &&
             valid_stick_counts(c.turn) && c.reversed <= (kSlideReversed | kSpinReversed);
  }
  return false;
}

// out: kDeviceCommandBytes. Precondition: valid_device_command().
inline void encode_device_command(const DeviceCommand& command, uint8_t* out) {
  out[0] = kDeviceCommandVersion;
  out[1] = command.kind;
  device_put16(out + 2, command.sequence);
  const bool stick = command.kind == kStickCommand;
  out[4] = command.rod;
  out[5] = stick ? command.reversed : command.amplitude;
  device_put16(out + 6, command.duration_ms);
  if (stick) {
    device_put16(out + 8, command.travel);
    device_put16(out + 10, command.turn);
  } else {
    out[8] = command.resolution;
    out[9] = command.brightness;
    out[10] = command.ps2;
    out[11] = command.switches;
  }
  device_put16(out + 12, 0);
  device_put16(out + 14, device_crc16(out, 14));
}

// Returns false, and leaves command unchanged, unless size, version, CRC and all ranges are valid.
inline bool decode_device_command(const uint8_t* in, size_t size, DeviceCommand& command) {
  if (size != kDeviceCommandBytes || in[0] != kDeviceCommandVersion) return false;
  if (device_get16(in + 12) != 0 || device_get16(in + 14) != device_crc16(in, 14)) return false;
  DeviceCommand read{};
  read.kind = in[1];
  read.sequence = device_get16(in + 2);
  read.rod = in[4];
  read.duration_ms = device_get16(in + 6);
  if (read.kind == kStickCommand) {
    read.reversed = in[5];
    read.travel = device_get16(in + 8);
    read.turn = device_get16(in + 10);
  } else {
    read.amplitude = in[5];
    read.resolution = in[8];
    read.brightness = in[9];
    read.ps2 = in[10];
    read.switches = in[11];
  }
  if (!valid_device_command(read)) return false;
  command = read;
  return true;
}

}  // namespace wire

#endif
