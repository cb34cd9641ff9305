// A controller's serial number as a USB string descriptor, in hexadecimal digits.
#ifndef FIRMWARE_CORE_SERIAL_STRING_H
#define FIRMWARE_CORE_SERIAL_STRING_H

#include <stdint.h>

namespace firmware {

template <uint8_t BYTES>
struct SerialString {
  uint8_t descriptor[2 + 4 * BYTES];

  void set(const uint8_t* id) {
    descriptor[0] = sizeof descriptor;
    descriptor[1] = 3;
    uint8_t* out = descriptor + 2;
    for (uint8_t i = 0; i < BYTES; ++i) {
      out = put(static_cast<uint8_t>(id[i] >> 4), out);
      out = put(static_cast<uint8_t>(id[i] & 0xF), out);
    }
  }

 private:
  static uint8_t* put(uint8_t digit, uint8_t* out) {
    *out++ = static_cast<uint8_t>(digit < 10 ? '0' + digit : 'A' + digit - 10);
    *out++ = 0;
    return out;
  }
};

}  // namespace firmware

#endif
