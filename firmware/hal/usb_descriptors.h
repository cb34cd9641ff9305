// What the device says of itself: one vendor-defined HID interface with one 64-byte input report
// and no report number. In flash.
#ifndef FIRMWARE_HAL_USB_DESCRIPTORS_H
#define FIRMWARE_HAL_USB_DESCRIPTORS_H

#include <stdint.h>

namespace firmware {

static const uint8_t kControlBytes = 64;  // endpoint 0's packet
static const uint8_t kReportEndpoint = 1;

struct Descriptor {
  const uint8_t* flash;
  uint8_t size;
};

// By the wValue and wIndex of GET_DESCRIPTOR; flash is null when there is none such.
Descriptor find_descriptor(uint16_t value, uint16_t index);

}  // namespace firmware

#endif
