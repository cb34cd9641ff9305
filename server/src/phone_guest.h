// What one phone says, and what it is told, as another client of the control port: the phone's
// messages (wire/phone_message.h) against control messages (wire/control.h). It has no socket and
// no clock; who carries the bytes is the phone port.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "foosball/table.h"
#include "seats.h"
#include "wire/control.h"
#include "wire/input_datagram.h"
#include "wire/phone_message.h"

namespace server {

// Rods as a phone has them: two lines of a team.
struct RodPairOf {
  RodSet rods = 0;
  std::array<int, wire::kPhoneRods> by_x{};  // the rods, the one at -x first
};
// Precondition: team 0 or 1, pair no RodPair::none.
RodPairOf rods_of_pair(foosball::Layout layout, int team, wire::RodPair pair);

// To the tick: what a phone wants of its rods.
struct PhoneInputEvent {
  std::uint32_t client = 0;
  wire::InputDatagram input;
};

class PhoneGuest {
 public:
  explicit PhoneGuest(foosball::Layout layout) : layout_(layout) {}

  // What follows from one message.
  struct Outcome {
    std::vector<wire::ControlMessage> to_control;
    std::vector<wire::PhoneReply> to_phone;
    std::optional<PhoneInputEvent> input;
    bool end = false;  // of the connection, behind to_phone
  };
  // A phone's message. One that is out of place ends the connection.
  Outcome hear(const wire::PhoneRequest& request);
  // The control port's answer.
  Outcome hear(const wire::ControlMessage& message);

  bool greeted() const { return greeted_; }         // has said hello
  std::uint32_t client() const { return client_; }  // 0: not welcomed yet
  // Which of the phone's rods this is; nothing: none.
  std::optional<std::uint8_t> index_of(int rod) const;

 private:
  void greet(const wire::PhoneHello& hello, Outcome& out);
  void claim(const wire::PhoneClaim& claim, Outcome& out);
  void drive(const wire::PhoneInput& input, Outcome& out);
  void look_at(const wire::Roster& roster, Outcome& out);
  void end(const std::string& why, Outcome& out);

  foosball::Layout layout_;
  bool greeted_ = false;
  std::uint32_t client_ = 0;
  std::uint32_t sequence_ = 0;        // of the inputs handed on
  std::uint32_t phone_sequence_ = 0;  // of the last one that came
  bool driven_ = false;               // one has come
  wire::PhoneState state_;            // as it was last told
  bool told_ = false;
};

}  // namespace server
