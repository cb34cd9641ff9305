// The interrupt's half of eight PS/2 links: one byte holds the clock of every mouse, another the
// data.
//
// sample() runs every kSampleUs. At 16.7 kHz a clock phase lasts 30 us, so each phase is seen at
// least once and each falling edge exactly once; data is stable from 5 us before the clock falls
// until 5 us after it rises, so the data read with the first low clock is the bit. Falling edges go
// into a ring that poll() empties: bits are assembled outside the interrupt.
//
// Sending must answer within the low phase (data is taken when the clock rises), so it is done
// here. The bits to send lie in planes, the next one of every mouse in planes_[0]: answering is one
// operation for all mice, and so is moving on, whatever bit each has reached.
#ifndef FIRMWARE_CORE_PS2_LINES_H
#define FIRMWARE_CORE_PS2_LINES_H

#include <stdint.h>

#include "core/sampling.h"

#define FIRMWARE_INLINE inline __attribute__((always_inline))

namespace firmware {

static const uint8_t kMice = 8;

// Longer loses bits at 16.7 kHz; at 16 MHz much shorter leaves no time for anything else.
static const uint8_t kSampleUs = 20;

struct Edges {
  uint8_t tick;  // sample number, wraps
  uint8_t fell;  // bit i: the clock of mouse i fell
  uint8_t data;  // data lines at that moment
};

class Ps2Lines {
 public:
  // ---- the interrupt's side
  // One sample. The clock is read twice, with count_sample() between, and a level counts only when
  // both agree: a spike shorter than that is no edge. drive(low) is called at once with the data
  // lines to pull low when they change: a mouse at 16.7 kHz takes its bit 30 us after the edge that
  // asked for it.
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
  // Between the two readings of the clock: it has to be done anyway and takes 0.3 us.
  FIRMWARE_INLINE void count_sample() { tick_ = static_cast<uint8_t>(tick_ + 1); }

  // ---- the polling side
  // The oldest edges not yet taken; false: none.
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
  // Samples with edges that found the ring full; wraps.
  uint8_t dropped() const { return dropped_; }

  void inhibit(uint8_t mouse);              // holds the clock low: the mouse must not send
  void release(uint8_t mouse);              // lets both lines go, whatever was under way
  void send(uint8_t mouse, uint8_t value);  // from inhibit: request to send, then value bit by bit
  bool sending(uint8_t mouse) const { return (sending_ & (1u << mouse)) != 0; }
  bool acknowledged(uint8_t mouse) const { return (acknowledged_ & (1u << mouse)) != 0; }

  uint8_t clock_low() const { return clock_low_; }
  uint8_t data_low() const { return data_low_; }

 private:
  // The ring is as long as a uint8_t counts, so that an offset wraps by itself. 64 samples with
  // edges are 1.3 ms of all mice talking; the longest stretch without a poll, making and handing
  // over a frame, is a quarter of that.
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

  // What follows runs for an answer only, a few hundred times in a mouse's life, but every register
  // it uses is saved at every sample: so asked_ lies in memory, and addresses are constant.

  // Plane I and those behind it move up by one for the mice asked.
  template <uint8_t I>
  FIRMWARE_INLINE void move_planes(Index<I>) {
    planes_[I] = static_cast<uint8_t>(planes_[I] ^ ((planes_[I] ^ planes_[I + 1]) & asked_));
    move_planes(Index<I + 1>());
  }
  FIRMWARE_INLINE void move_planes(Index<kPlanes - 1>) {}

  // Counts down, a bit of every mouse's counter in each plane. asked_ becomes those that were at 0.
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
    // These had sent all: the data line is now the mouse's acknowledge.
    sending_ = static_cast<uint8_t>(sending_ & ~asked_);
    acknowledged_ = static_cast<uint8_t>(acknowledged_ | (asked_ & ~data));
  }

  // Written by the interrupt; by the polling side only while sampling is held.
  volatile uint8_t tick_ = 0;
  uint8_t level_ = 0xFF;  // the clocks as last believed; low for those we hold: that is no edge
  volatile uint8_t clock_low_ = 0;
  volatile uint8_t data_low_ = 0;
  volatile uint8_t sending_ = 0;
  volatile uint8_t acknowledged_ = 0;
  volatile uint8_t asked_ = 0;  // mice whose bit is being prepared
  volatile uint8_t planes_[kPlanes] =
      {};  // bit i of the first: what mouse i gets at its next falling edge
  volatile uint8_t left_[kCounterPlanes] =
      {};  // bits left to present, least significant plane first

  // One writer each: head_ the interrupt, tail_ the polling side.
  volatile uint8_t head_ = 0;
  volatile uint8_t tail_ = 0;
  volatile uint8_t dropped_ = 0;
  volatile uint8_t ring_[256] = {};
};

}  // namespace firmware

#endif
