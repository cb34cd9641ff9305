#include "hal/twi.h"

#include <avr/cpufunc.h>

#include "core/sampling.h"

namespace firmware {

namespace {

const uint8_t kStatusBits = 0xF8;
const uint8_t kGo = _BV(TWINT) | _BV(TWEN) | _BV(TWIE);
const uint8_t kBitRate = 13;  // 16 MHz / (16 + 2 * 13) = 381 kHz: low for 1.31 us

// Data sheet, tables 24-3 and 24-4.
enum Status : uint8_t {
  kStarted = 0x08,
  kWriteTaken = 0x18,
  kByteTaken = 0x28,
  kReadTaken = 0x40,
  kByteRead = 0x58,  // received and not acknowledged: the last byte
};

}  // namespace

Twi::Transfer Twi::written(uint8_t address, const uint8_t* bytes, uint8_t size) {
  return {static_cast<uint8_t>(address << 1), size, {bytes[0], bytes[size - 1]}};
}

void Twi::write(uint8_t address, const uint8_t* bytes, uint8_t size) {
  begin(written(address, bytes, size));
  if (by_hand_) soft_.write(address, bytes, size);
}

void Twi::read(uint8_t address) {
  begin({static_cast<uint8_t>(address << 1 | 1), 0, {}});
  if (by_hand_) soft_.read(address);
}

bool Twi::chain(uint8_t address, const uint8_t* bytes, uint8_t size) {
  if (by_hand_) return false;
  const SamplingHeld held;  // also blocks the TWI interrupt
  if (state_ != kBusy) return false;
  next_ = written(address, bytes, size);
  return true;
}

void Twi::begin(const Transfer& transfer) {
  busy_ = true;
  by_hand_ = !I2cWires::clock() || !I2cWires::data();
  if (by_hand_) {
    TWCR = 0;
    return;
  }
  now_ = transfer;
  next_.size = 0;
  at_ = 0;
  timed_ = false;
  state_ = kBusy;
  _MemoryBarrier();  // complete the writes above before the interrupt
  TWSR = 0;
  TWBR = kBitRate;
  TWCR = kGo | _BV(TWSTA);
}

// Waits until STOP is on the lines.
I2cBus::State Twi::state() {
  if (by_hand_) return soft_.state();
  return (TWCR & _BV(TWSTO)) != 0 ? kBusy : state_;
}

void Twi::step(uint8_t tick) {
  if (by_hand_) {
    soft_.step(tick);
  } else {
    watch(tick);
  }
  busy_ = state() == kBusy;
  _MemoryBarrier();  // read the data below only after the transfer has ended
}

void Twi::watch(uint8_t tick) {
  if (!timed_) {
    timed_ = true;
    since_ = tick;
  }
  if (static_cast<uint8_t>(tick - since_) < kTimeoutTicks) return;
  const SamplingHeld held;  // also blocks the TWI interrupt
  if (state() != kBusy) return;
  TWCR = 0;  // releases both lines
  state_ = kFailed;
}

void Twi::on_interrupt() {
  switch (TWSR & kStatusBits) {
    case kStarted:
      TWDR = now_.first;
      TWCR = kGo;
      break;
    case kWriteTaken:
    case kByteTaken:
      if (at_ == now_.size) {
        end_write();
        break;
      }
      TWDR = now_.bytes[at_++];
      TWCR = kGo;
      break;
    case kReadTaken:
      TWCR = kGo;
      break;
    case kByteRead:
      now_.bytes[0] = TWDR;
      end(kIdle);
      break;
    default:
      end(kFailed);
      break;
  }
}

void Twi::end_write() {
  if (next_.size == 0) {
    end(kIdle);
    return;
  }
  now_ = next_;
  next_.size = 0;
  at_ = 0;
  TWCR = kGo | _BV(TWSTO) | _BV(TWSTA);
}

void Twi::end(State state) {
  TWCR = _BV(TWINT) | _BV(TWEN) | _BV(TWSTO);
  state_ = state;
}

}  // namespace firmware
