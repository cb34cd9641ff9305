// The frame from the cabinet's micro-controller to the PC, shared by firmware and PC: freestanding
// C++14, no library headers beyond <stdint.h> and <stddef.h>.
//
// Layout (little endian), kDeviceFrameBytes in all:
//   0  u8   version            kDeviceFrameVersion
//   1  u8   flags              bit 0: a mouse was re-synchronised since the last frame
//   2  u16  sequence           wraps
//   4  u32  time_us            micro-controller's clock, wraps
//   8  8 x { u16 slide, u16 spin }   cumulative counts, wrap: a lost frame loses nothing
//  40  u8   present            bit i: mouse i answers
//  41  u8   overflow           bit i: mouse i reported overflow since the last frame
//  42  u8   quality            parity and framing errors since the last frame, saturating
//  43  u8   index              bit i: the index mark of rod i is under its switch
//  44  u16  crc                CRC-16/CCITT-FALSE over bytes 0..43
// Version 1 has no index marks: its byte 43 is 0. It is read too.
// Over USB HID: one 64-byte vendor report, bytes 46..63 zero. Over a serial line: COBS, then a 0.
#ifndef WIRE_DEVICE_FRAME_H
#define WIRE_DEVICE_FRAME_H

#include <stddef.h>
#include <stdint.h>

namespace wire {

static const uint8_t kDeviceFrameVersion = 2;
static const size_t kDeviceFrameBytes = 46;
static const size_t kDeviceCobsBytes = 48;    // encoded, with the terminating 0
static const size_t kDeviceReportBytes = 64;  // HID report
static const int kDeviceRods = 8;

struct DeviceFrame {
  uint8_t flags;
  uint16_t sequence;
  uint32_t time_us;
  uint16_t slide[kDeviceRods];  // counts
  uint16_t spin[kDeviceRods];   // counts
  uint8_t present;
  uint8_t overflow;
  uint8_t quality;
  uint8_t index;
};

// Processes eight bits at once, with byte operations only: 27 cycles per byte on an AVR. A loop
// over the bits takes 80, 16-bit shifts take 37. A table would use too much of its memory.
inline uint16_t device_crc16(const uint8_t* bytes, size_t size) {
  uint8_t high = 0xFF, low = 0xFF;
  for (size_t i = 0; i < size; ++i) {
    uint8_t fold = static_cast<uint8_t>(high ^ bytes[i]);
    fold = static_cast<uint8_t>(fold ^ (fold >> 4));
    high = static_cast<uint8_t>(low ^ static_cast<uint8_t>(fold << 4) ^ (fold >> 3));
    low = static_cast<uint8_t>(fold ^ static_cast<uint8_t>(fold << 5));
  }
  return static_cast<uint16_t>(high << 8 | low);
}

inline void device_put16(uint8_t* out, uint16_t value) {
  out[0] = static_cast<uint8_t>(value);
  out[1] = static_cast<uint8_t>(value >> 8);
}

inline uint16_t device_get16(const uint8_t* in) {
  return static_cast<uint16_t>(in[0] | static_cast<uint16_t>(in[1] << 8));
}

// out: kDeviceFrameBytes.
inline void encode_device_frame(const DeviceFrame& frame, uint8_t* out) {
  out[0] = kDeviceFrameVersion;
  out[1] = frame.flags;
  device_put16(out + 2, frame.sequence);
  device_put16(out + 4, static_cast<uint16_t>(frame.time_us));
  device_put16(out + 6, static_cast<uint16_t>(frame.time_us >> 16));
  for (int rod = 0; rod < kDeviceRods; ++rod) {
    device_put16(out + 8 + 4 * rod, frame.slide[rod]);
    device_put16(out + 10 + 4 * rod, frame.spin[rod]);
  }
  out[40] = frame.present;
  out[41] = frame.overflow;
  out[42] = frame.quality;
  out[43] = frame.index;
  device_put16(out + 44, device_crc16(out, 44));
}

// Returns false, and leaves frame unchanged, unless size, version, the version's fields and CRC are
// valid.
inline bool decode_device_frame(const uint8_t* in, size_t size, DeviceFrame& frame) {
  if (size != kDeviceFrameBytes || in[0] < 1 || in[0] > kDeviceFrameVersion) return false;
  if (in[0] == 1 && in[43] != 0) return false;
  if (device_get16(in + 44) != device_crc16(in, 44)) return false;
  frame.flags = in[1];
  frame.sequence = device_get16(in + 2);
  frame.time_us = device_get16(in + 4) | static_cast<uint32_t>(device_get16(in + 6)) << 16;
  for (int rod = 0; rod < kDeviceRods; ++rod) {
    frame.slide[rod] = device_get16(in + 8 + 4 * rod);
    frame.spin[rod] = device_get16(in + 10 + 4 * rod);
  }
  frame.present = in[40];
  frame.overflow = in[41];
  frame.quality = in[42];
  frame.index = in[43];
  return true;
}

// COBS encoding of size <= 254 bytes, terminated by a 0. Returns the bytes written: size + 2. out:
// size + 2.
inline size_t cobs_encode(const uint8_t* in, size_t size, uint8_t* out) {
  size_t code_at = 0, written = 1;
  uint8_t code = 1;
  for (size_t i = 0; i < size; ++i) {
    if (in[i] != 0) {
      out[written++] = in[i];
      ++code;
    } else {
      out[code_at] = code;
      code_at = written++;
      code = 1;
    }
  }
  out[code_at] = code;
  out[written++] = 0;
  return written;
}

// in: one encoded frame without its terminating 0. Returns the decoded size, or 0 if the input is
// not COBS or needs more than capacity bytes.
inline size_t cobs_decode(const uint8_t* in, size_t size, uint8_t* out, size_t capacity) {
  size_t written = 0, i = 0;
  while (i < size) {
    const uint8_t code = in[i++];
    if (code == 0 || i + code - 1 > size) return 0;
    for (uint8_t k = 1; k < code; ++k) {
      if (in[i] == 0 || written == capacity) return 0;
      out[written++] = in[i++];
    }
    if (code < 0xFF && i < size) {
      if (written == capacity) return 0;
      out[written++] = 0;
    }
  }
  return written;
}

}  // namespace wire

#endif
