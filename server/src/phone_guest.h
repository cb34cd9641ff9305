// Translates between a phone's messages (wire/phone_message.h) and the control messages of a client
// (wire/control.h). It has no socket and no clock; the phone port transports the bytes.
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

// The rods of a phone: two lines of a team.
struct RodPairOf {
  RodSet rods = 0;
  std::array<int, wire::kPhoneRods> by_x{};  // the rods, the one at -x first
};
// Precondition: team is 0 or 1, pair is not RodPair::none.
RodPairOf rods_of_pair(foosball::Layout layout, int team, wire::RodPair pair);

// To the tick: a phone's rod targets.
struct PhoneInputEvent {
  std::uint32_t client = 0;
  wire::InputDatagram input;
};

class PhoneGuest {
 public:
  explicit PhoneGuest(foosball::Layout layout) : layout_(layout) {}

  // The result of one message.
  struct Outcome {
    std::vector<wire::ControlMessage> to_control;
    std::vector<wire::PhoneReply> to_phone;
    std::optional<PhoneInputEvent> input;
    bool end = false;  // close the connection after to_phone
  };
  // Handles a phone's message. One that is out of sequence ends the connection.
  Outcome handle(const wire::PhoneRequest& request);
  // Handles the control port's answer.
  Outcome handle(const wire::ControlMessage& message);

  bool greeted() const { return greeted_; }         // has sent a hello
  std::uint32_t client() const { return client_; }  // 0: no Welcome yet
  // Index of the rod among the phone's rods; nothing: not one of them.
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
  std::uint32_t sequence_ = 0;        // of the inputs passed on
  std::uint32_t phone_sequence_ = 0;  // of the last input received
  bool driven_ = false;               // an input was received
  wire::PhoneState state_;            // as last sent
  bool reported_ = false;
};

}  // namespace server
