// Parses three bytes into a movement: [yo xo ys xs 1 m r l] [x] [y], nine-bit two's complement
// deltas.
#ifndef FIRMWARE_CORE_MOUSE_PACKET_H
#define FIRMWARE_CORE_MOUSE_PACKET_H

#include <stdint.h>

namespace firmware {

struct Movement {
  int16_t slide;  // x [counts]
  int16_t spin;   // y [counts]
  bool overflow;  // the movement exceeded nine bits: the delta is saturated
};

class PacketParser {
 public:
  enum Event : uint8_t {
    kNone,
    kMovement,  // movement() has a new value
    kResync,    // synchronisation was lost, whether regained or not: bytes were dropped
  };

  // good: the byte's parity was correct. after_gap: silence preceded the byte, so it starts a
  // packet.
  Event byte(uint8_t value, bool good, bool after_gap);
  // Bits were lost, so byte boundaries are unknown: ignores all bytes until a gap.
  void lose();
  void reset();
  // Drops an incomplete packet after a silence. True: bytes were dropped.
  bool expire();

  const Movement& movement() const { return movement_; }
  bool between_packets() const { return index_ == 0; }
  // The incomplete packet is AA 00, which a mouse sends after power-on.
  bool looks_like_power_on() const { return index_ == 2 && !bad_ && head_ == 0xAA && x_ == 0x00; }

 private:
  Event finish(uint8_t y);

  Movement movement_ = {0, 0, false};
  uint8_t index_ = 0;
  uint8_t head_ = 0;
  uint8_t x_ = 0;
  bool bad_ = false;   // a byte of this packet had a parity error
  bool lost_ = false;  // waiting for a gap
};

}  // namespace firmware

#endif
