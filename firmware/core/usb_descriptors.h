// The device's USB descriptors: one vendor-defined HID interface with a 64-byte input and a 64-byte
// output report, one endpoint for each, no report IDs, and a serial number. With gamepads it is
// another product, with one more interface and endpoint for each gamepad: Linux merges all gamepads
// of an interface into one device. On an AVR they are in flash, a separate address space.
#ifndef FIRMWARE_CORE_USB_DESCRIPTORS_H
#define FIRMWARE_CORE_USB_DESCRIPTORS_H

#include <stdint.h>

namespace firmware {

static const uint8_t kControlBytes = 64;  // packet size of endpoint 0
static const uint8_t kReportEndpoint = 1;
#if defined(__AVR__)
static const uint8_t kCommandEndpoint = 2;  // an endpoint of the 32U4 has only one direction
#else
static const uint8_t kCommandEndpoint = 1;  // the other direction of kReportEndpoint
#endif

static const uint8_t kPads = 4;
static const uint8_t kPadBytes = 10;        // of a report: four axes and the buttons
static const uint8_t kPadEndpoint = 3;      // of the first gamepad; the others follow
static const uint8_t kPadPacketBytes = 16;  // smallest packet of an AVR that holds a report

// Index of the serial number string, which find_descriptor() does not return.
static const uint8_t kSerialString = 3;

struct Descriptor {
  const uint8_t* flash;
  uint8_t size;
};

// value, index: wValue and wIndex of GET_DESCRIPTOR. Returns a null flash pointer if there is no
// such descriptor.
Descriptor find_descriptor(uint16_t value, uint16_t index, bool gamepads);

}  // namespace firmware

#endif
