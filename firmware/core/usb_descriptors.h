// What the device says of itself: one vendor-defined HID interface with one 64-byte input report
// and no report number. A controller that takes commands has a 64-byte output report too, an
// endpoint for it, and a serial number of its own. Of the AVR in flash, which is another memory
// there.
#ifndef FIRMWARE_CORE_USB_DESCRIPTORS_H
#define FIRMWARE_CORE_USB_DESCRIPTORS_H

#include <stdint.h>

#if defined(__AVR__)
#define FIRMWARE_TAKES_COMMANDS 0
#else
#define FIRMWARE_TAKES_COMMANDS 1
#endif

namespace firmware {

static const uint8_t kControlBytes = 64;  // endpoint 0's packet
static const uint8_t kReportEndpoint = 1;
static const uint8_t kCommandEndpoint = 1;  // the other direction of it

// The string with the serial number, which find_descriptor() does not know; 0: there is none.
static const uint8_t kSerialString = FIRMWARE_TAKES_COMMANDS ? 3 : 0;

struct Descriptor {
  const uint8_t* flash;
  uint8_t size;
};

// By the wValue and wIndex of GET_DESCRIPTOR; flash is null when there is none such.
Descriptor find_descriptor(uint16_t value, uint16_t index);

}  // namespace firmware

#endif
