// UART0 at 1 Mbaud. A frame is copied and sent byte by byte from poll(). At 250 frames of 48 bytes,
// the line is busy an eighth of the time, so no interrupt is needed that could delay the sampling
// one. Commands are rare, but their bytes arrive ten times as fast as the loop iterates. Two bytes
// arrive in a sample period, which is what the UART buffers: so the sampling interrupt reads them.
// A separate interrupt would wait for the sampling one, and bytes would be lost.
#ifndef FIRMWARE_HAL_UART_H
#define FIRMWARE_HAL_UART_H

#include <stdint.h>

#include "core/ps2_lines.h"
#include "hal/board.h"

namespace firmware {

class Uart {
 public:
  void start();
  void poll();
  bool has_room(uint8_t size) const {
    return size < kRing - static_cast<uint8_t>((head_ - tail_) & kRingMask);
  }
  // Precondition: has_room(size).
  void send(const uint8_t* bytes, uint8_t size);

  // Called in each sampling interrupt.
  FIRMWARE_INLINE void receive() {
    for (uint8_t i = 0; i < 3 && (UCSR0A & _BV(RXC0)) != 0; ++i) receive_byte();
  }
  bool has_received() const { return received_tail_ != received_head_; }
  // Removes the oldest byte; false: none left.
  bool take(uint8_t& out) {
    const uint8_t tail = received_tail_;
    if (tail == received_head_) return false;
    out = received_[tail];
    received_tail_ = static_cast<uint8_t>(tail + 1);
    return true;
  }
  // Whether bytes were lost or damaged since the last call.
  bool take_lost() {
    if (lost_ == 0) return false;
    lost_ = 0;
    return true;
  }

 private:
  FIRMWARE_INLINE void receive_byte() {
    const uint8_t faults = UCSR0A & (_BV(FE0) | _BV(DOR0));
    const uint8_t value = UDR0;
    const uint8_t head = received_head_;
    const uint8_t next = static_cast<uint8_t>(head + 1);
    if (faults != 0 || next == received_tail_) {
      lost_ = 1;
      return;
    }
    received_[head] = value;
    received_head_ = next;
  }

  static const uint8_t kRing = 128;  // capacity: two frames to send
  static const uint8_t kRingMask = kRing - 1;

  uint8_t ring_[kRing] = {};
  uint8_t head_ = 0;
  uint8_t tail_ = 0;

  // Single writers: head the interrupt, tail the polling side. The size matches the range of a
  // uint8_t: twelve commands.
  volatile uint8_t received_[256] = {};
  volatile uint8_t received_head_ = 0;
  volatile uint8_t received_tail_ = 0;
  volatile uint8_t lost_ = 0;
};

}  // namespace firmware

#endif
