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

// pid.codes' IDs for tests and prototypes: a product for sale needs its own. There are two, because
// hosts cache the interfaces of a product.
const uint16_t kUsbVendor = 0x1209, kUsbProduct = 0x0001, kGamepadsProduct = 0x0002,
               kUsbRelease = 0x0100;

template <uint8_t N>
struct Bytes {
  uint8_t at[N];
};

constexpr Bytes<18> device(uint16_t product) {
  return {{18, 1, low(0x0200), high(0x0200), 0, 0, 0, kControlBytes, low(kUsbVendor),
           high(kUsbVendor), low(product), high(product), low(kUsbRelease), high(kUsbRelease), 1, 2,
           kSerialString, 1}};
}
constexpr Bytes<18> kDevice FIRMWARE_FLASH = device(kUsbProduct);
constexpr Bytes<18> kGamepadsDevice FIRMWARE_FLASH = device(kGamepadsProduct);

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
                                          0x09, 0x02,  //   usage: command; same size and count
                                          0x91, 0x02,  //   output: data, variable, absolute
                                          0xC0};

// Axes have a full scale of 15 bits with centre 0. Button 1 makes it a gamepad for Linux and SDL.
// They expect the right stick on Rx and Ry. Buttons up to Start keep games from asking for another
// gamepad.
const uint8_t kPadReport[] FIRMWARE_FLASH = {0x05, 0x01,        // usage page: generic desktop
                                             0x09, 0x05,        // usage: gamepad
                                             0xA1, 0x01,        // collection: application
                                             0x16, 0x01, 0x80,  //   -32767
                                             0x26, 0xFF, 0x7F,  //   to 32767
                                             0x75, 0x10,        //   of 16 bits
                                             0x95, 0x04,        //   4 of them
                                             0x09, 0x30,        //   usage: X
                                             0x09, 0x31,        //   usage: Y
                                             0x09, 0x33,        //   usage: Rx
                                             0x09, 0x34,        //   usage: Ry
                                             0x81, 0x02,        //   input: data, variable, absolute
                                             0x05, 0x09,        //   usage page: button
                                             0x19, 0x01,        //   1
                                             0x29, 0x0C,        //   to 12
                                             0x15, 0x00,        //
                                             0x25, 0x01,        //
                                             0x75, 0x01,        //   of 1 bit
                                             0x95, 0x0C,        //   12 of them
                                             0x81, 0x02,        //   input
                                             0x95, 0x04,        //   4 bits
                                             0x81, 0x03,        //   of padding
                                             0xC0};

// Eight sensors need more power than a port supplies: see docs/wiring.md.
const uint8_t kSelfPowered = 0xC0;
const uint8_t kMilliampsHalved = 50;
const uint8_t kHid = 3, kInterrupt = 3, kEveryFrame = 1;
const uint8_t kHeadBytes = 9, kInterfaceBytes = 9, kHidBytes = 9, kEndpointBytes = 7;
const uint8_t kFramesBytes = kInterfaceBytes + kHidBytes + 2 * kEndpointBytes;
const uint8_t kPadInterfaceBytes = kInterfaceBytes + kHidBytes + kEndpointBytes;

constexpr uint8_t hid_at(uint8_t interface) {
  return static_cast<uint8_t>(
      kHeadBytes + kInterfaceBytes +
      (interface == 0 ? 0 : kFramesBytes + (interface - 1) * kPadInterfaceBytes));
}

template <uint8_t N>
struct Writer {
  Bytes<N> out{};
  uint8_t at = 0;

  template <uint8_t M>
  constexpr void put(const Bytes<M>& part) {
    for (uint8_t i = 0; i < M; ++i) out.at[at++] = part.at[i];
  }
  constexpr void interface(uint8_t number, uint8_t endpoints, uint8_t report_bytes) {
    put(Bytes<kInterfaceBytes>{
        {kInterfaceBytes, 4, number, 0, endpoints, kHid, 0, 0, 0}});  // no boot protocol
    put(Bytes<kHidBytes>{{kHidBytes, 0x21, 0x11, 0x01, 0, 1, 0x22, report_bytes, 0}});
  }
  constexpr void endpoint(uint8_t address, uint8_t packet_bytes) {
    put(Bytes<kEndpointBytes>{
        {kEndpointBytes, 5, address, kInterrupt, packet_bytes, 0, kEveryFrame}});
  }
};

template <uint8_t PADS>
constexpr Bytes<kHeadBytes + kFramesBytes + PADS * kPadInterfaceBytes> configuration() {
  Writer<kHeadBytes + kFramesBytes + PADS * kPadInterfaceBytes> writer;
  writer.put(Bytes<kHeadBytes>{
      {kHeadBytes, 2, sizeof writer.out, 0, 1 + PADS, 1, 0, kSelfPowered, kMilliampsHalved}});
  writer.interface(0, 2, sizeof kReport);
  writer.endpoint(0x80 | kReportEndpoint, wire::kDeviceReportBytes);
  writer.endpoint(kCommandEndpoint, wire::kDeviceReportBytes);
  for (uint8_t pad = 0; pad < PADS; ++pad) {
    writer.interface(static_cast<uint8_t>(1 + pad), 1, sizeof kPadReport);
    writer.endpoint(static_cast<uint8_t>(0x80 | (kPadEndpoint + pad)), kPadPacketBytes);
  }
  return writer.out;
}
constexpr auto kConfiguration FIRMWARE_FLASH = configuration<0>();
constexpr auto kGamepadsConfiguration FIRMWARE_FLASH = configuration<kPads>();

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
template <uint8_t N>
Descriptor whole(const Bytes<N>& flash) {
  return {flash.at, N};
}

Descriptor find_string(uint8_t number) {
  if (number == 0) return whole(kLanguages);
  if (number == 1) return whole(kMaker);
  if (number == 2) return whole(kName);
  return {nullptr, 0};
}

}  // namespace

Descriptor find_descriptor(uint16_t value, uint16_t index, bool gamepads) {
  const uint8_t number = low(value);
  const bool there = index == 0 || (gamepads && index <= kPads);
  switch (high(value)) {
    case 1:
      if (number == 0) return gamepads ? whole(kGamepadsDevice) : whole(kDevice);
      break;
    case 2:
      if (number == 0) return gamepads ? whole(kGamepadsConfiguration) : whole(kConfiguration);
      break;
    case 3:
      return find_string(number);
    case 0x21:
      if (there) return {kGamepadsConfiguration.at + hid_at(low(index)), kHidBytes};
      break;
    case 0x22:
      if (there) return index == 0 ? whole(kReport) : whole(kPadReport);
      break;
  }
  return {nullptr, 0};
}

}  // namespace firmware
