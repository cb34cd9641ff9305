#include "core/usb_descriptors.h"

#if defined(__AVR__)
#include <avr/pgmspace.h>
#define FIRMWARE_FLASH PROGMEM
#else
#define FIRMWARE_FLASH
#endif

#include "wire/device_frame.h"

namespace firmware {

namespace {

constexpr uint8_t low(uint16_t value) {
  return static_cast<uint8_t>(value);
}
constexpr uint8_t high(uint16_t value) {
  return static_cast<uint8_t>(value >> 8);
}

// pid.codes' number for tests and prototypes: a cabinet that is sold needs its own.
const uint16_t kUsbVendor = 0x1209, kUsbProduct = 0x0001, kUsbRelease = 0x0100;

const uint8_t kDevice[] FIRMWARE_FLASH = {18,
                                          1,
                                          low(0x0200),
                                          high(0x0200),
                                          0,
                                          0,
                                          0,
                                          kControlBytes,
                                          low(kUsbVendor),
                                          high(kUsbVendor),
                                          low(kUsbProduct),
                                          high(kUsbProduct),
                                          low(kUsbRelease),
                                          high(kUsbRelease),
                                          1,
                                          2,
                                          kSerialString,
                                          1};

const uint8_t kReport[] FIRMWARE_FLASH = {0x06, 0x00,
                                          0xFF,        // usage page: vendor defined
                                          0x09, 0x01,  // usage: cabinet frame
                                          0xA1, 0x01,  // collection: application
                                          0x15, 0x00,
                                          0x26, 0xFF,
                                          0x00,                            //   bytes
                                          0x75, 0x08,                      //
                                          0x95, wire::kDeviceReportBytes,  //   64 of them
                                          0x09, 0x01,
                                          0x81, 0x02,  //   input: data, variable, absolute
                                          0x09, 0x02,  //   usage: command; as many bytes
                                          0x91, 0x02,  //   output: data, variable, absolute
                                          0xC0};

const uint8_t kHidVersionLow = 0x11, kHidVersionHigh = 0x01;
const uint8_t kSelfPowered = 0xC0;  // eight sensors need more than a port gives: see docs/wiring.md
const uint8_t kMilliampsHalved = 50;
const uint8_t kInterrupt = 3, kEveryFrame = 1;
const uint8_t kEndpoints = 2;
const uint8_t kConfigurationBytes = 9 + 9 + 9 + 7 * kEndpoints;
const uint8_t kHidAt = 9 + 9;

const uint8_t kConfiguration[] FIRMWARE_FLASH = {
    9,
    2,
    kConfigurationBytes,
    0,
    1,
    1,
    0,
    kSelfPowered,
    kMilliampsHalved,
    9,
    4,
    0,
    0,
    kEndpoints,
    3,
    0,
    0,
    0,  // interface: HID, no boot protocol
    9,
    0x21,
    kHidVersionLow,
    kHidVersionHigh,
    0,
    1,
    0x22,
    sizeof kReport,
    0,
    7,
    5,
    0x80 | kReportEndpoint,
    kInterrupt,
    wire::kDeviceReportBytes,
    0,
    kEveryFrame,
    7,
    5,
    kCommandEndpoint,
    kInterrupt,
    wire::kDeviceReportBytes,
    0,
    kEveryFrame,
};
static_assert(sizeof kConfiguration == kConfigurationBytes, "wTotalLength");

const uint8_t kLanguages[] FIRMWARE_FLASH = {4, 3, 0x09, 0x04};  // English
const uint8_t kMaker[] FIRMWARE_FLASH = {30,  3, 'S', 0, 'p', 0, 'a', 0, 'c', 0,
                                         'e', 0, ' ', 0, 'F', 0, 'o', 0, 'o', 0,
                                         's', 0, 'b', 0, 'a', 0, 'l', 0, 'l', 0};
const uint8_t kName[] FIRMWARE_FLASH = {16,  3, 'C', 0, 'a', 0, 'b', 0,
                                        'i', 0, 'n', 0, 'e', 0, 't', 0};
static_assert(sizeof kMaker == 30 && sizeof kName == 16, "bLength");

template <uint8_t N>
Descriptor whole(const uint8_t (&flash)[N]) {
  return {flash, N};
}

Descriptor find_string(uint8_t number) {
  if (number == 0) return whole(kLanguages);
  if (number == 1) return whole(kMaker);
  if (number == 2) return whole(kName);
  return {nullptr, 0};
}

}  // namespace

Descriptor find_descriptor(uint16_t value, uint16_t index) {
  const uint8_t number = low(value);
  switch (high(value)) {
    case 1:
      if (number == 0) return whole(kDevice);
      break;
    case 2:
      if (number == 0) return whole(kConfiguration);
      break;
    case 3:
      return find_string(number);
    case 0x21:
      if (index == 0) return {kConfiguration + kHidAt, 9};
      break;
    case 0x22:
      if (index == 0) return whole(kReport);
      break;
  }
  return {nullptr, 0};
}

}  // namespace firmware
