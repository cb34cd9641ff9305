// Three bytes into a movement: [yo xo ys xs 1 m r l] [x] [y], nine-bit two's complement deltas.
#ifndef FIRMWARE_CORE_MOUSE_PACKET_H
#define FIRMWARE_CORE_MOUSE_PACKET_H

#include <stdint.h>

namespace firmware {

struct Movement {
  int16_t slide;  // x [counts]
  int16_t spin;   // y [counts]
  bool overflow;  // the mouse moved further than nine bits hold: the delta stands at its limit
};

class PacketParser {
 public:
  enum Event : uint8_t {
    kNone,
    kMovement,  // movement() is new
    kResync,    // out of step and found again, or still looking: bytes were thrown away
  };

  // value: a byte, good unless its parity was wrong; after_gap: silence came before it, so that it
  // begins a packet whatever was expected.
  Event byte(uint8_t value, bool good, bool after_gap);
  // Bits were lost, so where bytes begin is unknown: nothing counts until a gap.
  void lose();
  void reset();
  // Ends an unfinished packet after a silence. True: bytes were thrown away.
  bool expire();

  const Movement& movement() const { return movement_; }
  bool between_packets() const { return index_ == 0; }
  // The unfinished packet is AA 00: a mouse that says it has just been powered.
  bool looks_like_power_on() const { return index_ == 2 && !bad_ && head_ == 0xAA && x_ == 0x00; }

 private:
  Event finish(uint8_t y);

  Movement movement_ = {0, 0, false};
  uint8_t index_ = 0;
  uint8_t head_ = 0;
  uint8_t x_ = 0;
  bool bad_ = false;   // a byte of this packet had wrong parity
  bool lost_ = false;  // waiting for a gap
};

}  // namespace firmware

#endif
