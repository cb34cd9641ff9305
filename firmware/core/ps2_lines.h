// The interrupt side of eight PS/2 links: one byte holds the clocks of all mice, another the data
// lines.
//
// sample() runs every kSampleUs. At 16.7 kHz a clock phase lasts 30 us, so sampling sees each phase
// at least once and each falling edge exactly once. Data is stable from 5 us before the clock falls
// until 5 us after it rises, so the data read with the first low clock is the bit. Falling edges go
// into a ring that the polling loop empties: it assembles the bits outside the interrupt.
//
// A sender must drive its data within the low phase (the mouse samples it when the clock rises), so
// the interrupt sends. The bits to send are stored in bit planes: planes_[0] holds the next bit of
// every mouse. Driving the lines and advancing are each one operation for all mice, whatever bit
// each has reached.
#ifndef FIRMWARE_CORE_PS2_LINES_H
#define FIRMWARE_CORE_PS2_LINES_H

#include <stdint.h>

#include "core/sampling.h"

#define FIRMWARE_INLINE inline __attribute__((always_inline))

namespace firmware {

static const uint8_t kMice = 8;

// A longer period loses bits at 16.7 kHz. A much shorter one leaves no other processor time at 16
// MHz.
static const uint8_t kSampleUs = 20;

struct Edges {
  uint8_t tick;  // sample number, wraps
  uint8_t fell;  // bit i: the clock of mouse i fell
  uint8_t data;  // data lines at that moment
};

class Ps2Lines {
 public:
  // ---- interrupt side
  // Processes one sample. The clock is read twice, with count_sample() in between. A level counts
  // only if both agree, which rejects shorter spikes. sample() calls drive(low) at once when the
  // set of data lines to pull low changes: a mouse at 16.7 kHz samples its bit 30 us after the
  // requesting edge.
  template <typename Drive>
  FIRMWARE_INLINE void sample(uint8_t clock, uint8_t data, uint8_t clock_again, Drive drive) {
    const uint8_t before = level_;
    const uint8_t now =
        static_cast<uint8_t>((clock & clock_again) | (before & (clock | clock_again)));
    level_ = now;
    uint8_t fell = static_cast<uint8_t>(before & ~now);
    if (fell == 0) return;
    const uint8_t asked = static_cast<uint8_t>(fell & sending_);
    if (asked != 0) {
      data_low_ = static_cast<uint8_t>((data_low_ & ~asked) | (asked & ~planes_[0]));
      drive(data_low_);
      asked_ = asked;
      prepare_next(data);
      fell = static_cast<uint8_t>(fell & ~asked);
    }
    if (fell != 0) push(fell, data);
  }
  // Called between the two reads of the clock: it is needed anyway and takes 0.3 us.
  FIRMWARE_INLINE void count_sample() { tick_ = static_cast<uint8_t>(tick_ + 1); }

  // ---- polling side
  // Removes the oldest edges; false: none left.
  bool pop(Edges& out) {
    const uint8_t tail = tail_;
    if (tail == head_) return false;
    const volatile uint8_t* at = ring_ + tail;
    out.tick = at[0];
    out.fell = at[1];
    out.data = at[2];
    tail_ = static_cast<uint8_t>(tail + kEntry);
    return true;
  }
  bool empty() const { return tail_ == head_; }
  uint8_t tick() const { return tick_; }
  // Number of samples with edges that were dropped because the ring was full; wraps.
  uint8_t dropped() const { return dropped_; }

  void inhibit(uint8_t mouse);  // holds the clock low: the mouse must not send
  void release(uint8_t mouse);  // releases both lines and aborts a transfer in progress
  // After inhibit(): request to send, then the bits of value.
  void send(uint8_t mouse, uint8_t value);
  bool sending(uint8_t mouse) const { return (sending_ & (1u << mouse)) != 0; }
  bool acknowledged(uint8_t mouse) const { return (acknowledged_ & (1u << mouse)) != 0; }

  uint8_t clock_low() const { return clock_low_; }
  uint8_t data_low() const { return data_low_; }

 private:
  // The ring has 256 bytes, so that a uint8_t offset wraps by itself. 64 samples with edges are 1.3
  // ms in which all mice send. The longest interval without a poll, while a frame is made and sent,
  // is a quarter of that.
  static const uint8_t kEntry = 4;    // tick, fell, data, unused
  static const uint8_t kPlanes = 10;  // 8 data bits, parity, stop
  static const uint8_t kCounterPlanes = 4;
  template <uint8_t I>
  struct Index {};

  FIRMWARE_INLINE void push(uint8_t fell, uint8_t data) {
    const uint8_t head = head_;
    const uint8_t next = static_cast<uint8_t>(head + kEntry);
    if (next == tail_) {
      dropped_ = static_cast<uint8_t>(dropped_ + 1);
      return;
    }
    volatile uint8_t* at = ring_ + head;
    at[0] = tick_;
    at[1] = fell;
    at[2] = data;
    head_ = next;
  }

  // The functions below run only while sending, a few hundred times per mouse. But every register
  // they use is saved at every sample. So asked_ is in memory, and addresses are constant.

  // Shifts plane I and the following ones by one bit for the mice in asked_.
  template <uint8_t I>
  FIRMWARE_INLINE void move_planes(Index<I>) {
    planes_[I] = static_cast<uint8_t>(planes_[I] ^ ((planes_[I] ^ planes_[I + 1]) & asked_));
    move_planes(Index<I + 1>());
  }
  FIRMWARE_INLINE void move_planes(Index<kPlanes - 1>) {}

  // Decrements the counters, stored as bit planes. asked_ keeps the mice whose counter was 0.
  template <uint8_t I>
  FIRMWARE_INLINE void count_down(Index<I>) {
    left_[I] = static_cast<uint8_t>(left_[I] ^ asked_);
    asked_ = static_cast<uint8_t>(asked_ & left_[I]);
    count_down(Index<I + 1>());
  }
  FIRMWARE_INLINE void count_down(Index<kCounterPlanes>) {}

  FIRMWARE_INLINE void prepare_next(uint8_t data) {
    move_planes(Index<0>());
    count_down(Index<0>());
    // These have sent all bits: the data line now carries the mouse's acknowledge.
    sending_ = static_cast<uint8_t>(sending_ & ~asked_);
    acknowledged_ = static_cast<uint8_t>(acknowledged_ | (asked_ & ~data));
  }

  // Written by the interrupt; by the polling side only while it holds sampling.
  volatile uint8_t tick_ = 0;
  // Debounced clock levels; low for inhibited mice, so that inhibiting is no edge.
  uint8_t level_ = 0xFF;
  volatile uint8_t clock_low_ = 0;
  volatile uint8_t data_low_ = 0;
  volatile uint8_t sending_ = 0;
  volatile uint8_t acknowledged_ = 0;
  volatile uint8_t asked_ = 0;  // mice whose bit is being prepared
  volatile uint8_t planes_[kPlanes] =
      {};  // bit i of planes_[0]: what mouse i gets at its next falling edge
  volatile uint8_t left_[kCounterPlanes] =
      {};  // bits left to present, least significant plane first

  // Single writers: head_ the interrupt, tail_ the polling side.
  volatile uint8_t head_ = 0;
  volatile uint8_t tail_ = 0;
  volatile uint8_t dropped_ = 0;
  volatile uint8_t ring_[256] = {};
};

}  // namespace firmware

#endif
