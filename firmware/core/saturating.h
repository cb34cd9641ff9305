// Saturating counters of a frame.
#ifndef FIRMWARE_CORE_SATURATING_H
#define FIRMWARE_CORE_SATURATING_H

#include <stdint.h>

namespace firmware {

inline uint8_t add_saturating(uint8_t a, uint8_t b) {
  return static_cast<uint8_t>(b > 255 - a ? 255 : a + b);
}

}  // namespace firmware

#endif
