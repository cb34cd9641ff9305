// Odd parity: the number of ones in a byte and its parity bit is odd.
#ifndef FIRMWARE_CORE_PS2_PARITY_H
#define FIRMWARE_CORE_PS2_PARITY_H

#include <stdint.h>

namespace firmware {

inline bool odd_ones(uint8_t value) {
  value = static_cast<uint8_t>(value ^ (value >> 4));
  value = static_cast<uint8_t>(value ^ (value >> 2));
  value = static_cast<uint8_t>(value ^ (value >> 1));
  return (value & 1) != 0;
}

}  // namespace firmware

#endif
