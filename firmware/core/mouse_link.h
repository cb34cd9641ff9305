// One PS/2 mouse from power-on to movements: reset (FF: FA AA 00), rate 200 (F3 C8), 8 counts/mm
// (E8 03), stream mode (EA), then enable (F4) once the gate opens for all. The sequence runs
// automatically whenever a mouse is plugged in, and again after it disappears.
//
// A mouse at rest sends nothing, so the link requests data (EB) from a silent one. The response
// carries the movement since the last packet, so no count is lost. No response means that the mouse
// is gone. A mouse that moves but reports only on request has reset unnoticed, and is set up again.
#ifndef FIRMWARE_CORE_MOUSE_LINK_H
#define FIRMWARE_CORE_MOUSE_LINK_H

#include <stdint.h>

#include "core/mouse_packet.h"
#include "core/ps2_lines.h"
#include "core/ps2_receiver.h"

namespace firmware {

class MouseLink {
 public:
  enum State : uint8_t {
    kAbsent,   // no answer; a reset is tried every kRetryMs
    kPause,    // lets the mouse finish its byte before the host inhibits the clock
    kInhibit,  // host holds the clock low
    kSend,     // the mouse clocks the command out of the host
    kReply,    // waiting for FA
    kBat,      // waiting for AA 00, the end of its self-test
    kGate,     // set up, waiting to be enabled together with the others
    kStream,
  };
  enum Event : uint8_t {
    kNone,
    kMovement,  // movement() has a new value
    kResync,
    kError,  // parity or framing error
  };

  MouseLink(Ps2Lines& lines, uint8_t mouse) : lines_(lines), mouse_(mouse) {}

  // Handles a falling edge of this mouse's clock, in the same parts as Ps2Receiver.
  uint8_t gap_before(uint8_t tick) { return receiver_.gap_before(tick); }
  bool data_bit(uint8_t gap, uint8_t bit) { return receiver_.data_bit(gap, bit); }
  Event other_bit(uint8_t gap, uint8_t bit, uint16_t now_ms);
  // Handles timeouts and sends the next command; call at least every 4 ms. now_ms wraps.
  Event step(uint8_t tick, uint16_t now_ms, bool gate_open);

  uint8_t mouse() const { return mouse_; }
  State state() const { return state_; }
  // Enabled and answering, as far as is known.
  bool present() const { return present_; }
  // Set up as far as possible without the others.
  bool waits_at_gate() const { return state_ == kGate; }
  const Movement& movement() const { return parser_.movement(); }

  static const uint8_t kInhibitTicks = 6;   // 120 us; the mouse needs at least 100
  static const uint16_t kSendMs = 20;       // a mouse starts to clock within 15 ms
  static const uint16_t kReplyMs = 25;      // a mouse answers within 20 ms
  static const uint16_t kBatMs = 1000;      // self-tests of 300 to 750 ms are usual
  static const uint16_t kRetryMs = 100;     // between resets of an absent mouse
  static const uint16_t kSilenceMs = 250;   // after which a streaming mouse is checked
  static const uint16_t kUnfinishedMs = 5;  // after which an incomplete packet is dropped
  static const uint8_t kTries = 3;          // attempts for each command
  // Consecutive responses to EB with movement, without a streamed packet in between. One in fifty
  // responses of a streaming mouse has movement, that of the few milliseconds before the request.
  static const uint8_t kMaxAnswers = 3;

 private:
  Event error() const;
  Event on_byte(uint8_t value, bool good, uint16_t now_ms);
  Event on_stream_byte(uint8_t value, bool good, uint16_t now_ms);
  void count_answer();
  void on_reply(uint8_t value, uint16_t now_ms);
  void restart();
  void begin(uint8_t command);
  void acknowledged(uint16_t now_ms);
  void stream(uint16_t now_ms);
  void take_hold();
  void try_again(uint16_t now_ms);
  void give_up(uint16_t now_ms);
  void send_command(uint16_t now_ms);
  Event tend_stream(uint16_t now_ms);

  Ps2Receiver receiver_;
  Ps2Lines& lines_;
  const uint8_t mouse_;
  PacketParser parser_;
  State state_ = kAbsent;
  bool present_ = false;
  bool asking_ = false;     // the current command is EB, not one of the script
  bool answering_ = false;  // the next packet is the response to EB
  uint8_t answers_ = 0;     // responses with movement since the last streamed packet
  uint8_t script_at_ = 0;
  uint8_t command_ = 0;
  uint8_t tries_ = 0;
  uint8_t last_byte_ = 0;
  uint8_t since_tick_ = 0;
  uint16_t deadline_ms_ = 0;  // in kAbsent: time of the next attempt
  uint16_t received_ms_ = 0;  // last complete packet
  uint16_t byte_ms_ = 0;
};

}  // namespace firmware

#endif
