// UART0 at 1 Mbaud, sending only. A frame is copied and goes out byte by byte from poll(): at 250
// frames of 48 bytes the line is busy an eighth of the time, so no interrupt is needed that could
// delay the sampling one.
#ifndef FIRMWARE_HAL_UART_H
#define FIRMWARE_HAL_UART_H

#include <stdint.h>

namespace firmware {

class Uart {
 public:
  void start();
  void poll();
  // Takes all of it or, when it does not fit, nothing.
  bool send(const uint8_t* bytes, uint8_t size);

 private:
  static const uint8_t kRing = 128;  // two frames
  static const uint8_t kRingMask = kRing - 1;

  uint8_t ring_[kRing] = {};
  uint8_t head_ = 0;
  uint8_t tail_ = 0;
};

}  // namespace firmware

#endif
