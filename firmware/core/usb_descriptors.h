// What the device says of itself: one vendor-defined HID interface with a 64-byte input and a
// 64-byte output report, an endpoint for each, no report numbers, and a serial number of its own.
// As gamepads it is another product, with an interface and an endpoint more for each of them: Linux
// makes one device of all gamepads of an interface. Of the AVR in flash, which is another memory
// there.
#ifndef FIRMWARE_CORE_USB_DESCRIPTORS_H
#define FIRMWARE_CORE_USB_DESCRIPTORS_H

#include <stdint.h>

namespace firmware {

static const uint8_t kControlBytes = 64;  // endpoint 0's packet
static const uint8_t kReportEndpoint = 1;
#if defined(__AVR__)
static const uint8_t kCommandEndpoint = 2;  // an endpoint of the 32U4 has one direction
#else
static const uint8_t kCommandEndpoint = 1;  // the other direction of the reports' one
#endif

static const uint8_t kPads = 4;
static const uint8_t kPadBytes = 10;        // of a report: four axes and the buttons
static const uint8_t kPadEndpoint = 3;      // of the first; the others follow
static const uint8_t kPadPacketBytes = 16;  // the smallest that holds a report, of an AVR

// The string with the serial number, which find_descriptor() does not know.
static const uint8_t kSerialString = 3;

struct Descriptor {
  const uint8_t* flash;
  uint8_t size;
};

// By the wValue and wIndex of GET_DESCRIPTOR; flash is null when there is none such.
Descriptor find_descriptor(uint16_t value, uint16_t index, bool gamepads);

}  // namespace firmware

#endif
