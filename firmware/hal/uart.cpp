#include "hal/uart.h"

#include "hal/board.h"

namespace firmware {

void Uart::start() {
  UCSR0A = _BV(U2X0);
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UBRR0 = 1;  // 16 MHz / (8 * 2) = 1 Mbaud, exact
  UCSR0B = _BV(TXEN0) | _BV(RXEN0);
}

void Uart::poll() {
  if (tail_ == head_ || (UCSR0A & _BV(UDRE0)) == 0) return;
  UDR0 = ring_[tail_];
  tail_ = static_cast<uint8_t>((tail_ + 1) & kRingMask);
}

void Uart::send(const uint8_t* bytes, uint8_t size) {
  for (uint8_t i = 0; i < size; ++i) {
    ring_[head_] = bytes[i];
    head_ = static_cast<uint8_t>((head_ + 1) & kRingMask);
  }
}

}  // namespace firmware
