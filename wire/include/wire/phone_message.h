// The messages between the server and a phone that plays as a pair of rods: one message per binary
// WebSocket message, in both directions. wire/phone_description.h describes their content. All
// fields are whole bytes, so that a page can read them with a DataView.
//
// Frame: the table frame (foosball/table.h). A slide is along +y, an angle is a right-handed
// rotation about +y. At angle 0 the men hang straight down.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "wire/enums.h"

namespace wire {

inline constexpr std::uint8_t kPhoneVersion = 1;
inline constexpr int kPhoneRods = 2;
inline constexpr std::size_t kMaxPhoneName = 32;  // bytes
inline constexpr std::size_t kMaxPhoneText = 200;
// Max size of a message [bytes]. A longer one from a phone ends its connection.
inline constexpr std::size_t kMaxPhoneRequest = 64;
inline constexpr std::size_t kMaxPhoneReply = 256;

// Two rods of a team, by their lines.
enum class RodPair : std::uint8_t {
  defence = 0,  // goalie and defence
  attack = 1,   // midfield and attack
  none = 2,     // watches
};
inline constexpr unsigned kRodPairCount = number(RodPair::none) + 1;

// --- phone to server

// First message, within 5 s of connecting.
struct PhoneHello {
  std::uint64_t session = 0;  // with ticket: of the last PhoneState, to resume the
  std::uint64_t ticket = 0;   // same seat; 0: a new one
  std::string name;           // at most kMaxPhoneName bytes of UTF-8
};

// Replaces the phone's rods. The answer is a PhoneState, or a PhoneNotice with the reason why not.
struct PhoneClaim {
  std::uint8_t team = 0;                      // 0, 1
  std::uint8_t pair = number(RodPair::none);  // RodPair
};

struct PhoneRod {
  bool driven = false;                   // false: the other fields have no meaning
  float slide = 0;                       // target [m]
  double angle = 0;                      // target [rad], full revolutions count; wraps at 65536
  float slide_rate = 0, angle_rate = 0;  // [m/s], [rad/s]
};

// Sent on every change, and at least 20 times per second.
struct PhoneInput {
  std::uint32_t sequence = 0;               // counts up
  std::array<PhoneRod, kPhoneRods> rods{};  // of the pair, the one at -x first
};

using PhoneRequest = std::variant<PhoneHello, PhoneClaim, PhoneInput>;

// --- server to phone

struct PhoneRodPlace {
  std::uint8_t line = 0;  // 0 goalie .. 3 attack
  std::uint8_t men = 0;   // 1..kMenOnRod
  float spacing = 0;      // between neighbours [m]
  float slide_limit = 0;  // |slide| <= this [m]
};

// Sent after the hello, and after each change of the rods' assignment.
struct PhoneState {
  std::uint64_t session = 0, ticket = 0;         // for the next PhoneHello
  std::uint8_t team = 0;                         // 0, 1; no meaning without a pair
  std::uint8_t pair = number(RodPair::none);     // RodPair of this phone
  std::uint8_t free = 0;                         // available pairs: bit 2 * team + pair
  std::array<PhoneRodPlace, kPhoneRods> rods{};  // of the pair, as PhoneInput::rods
  std::string name;                              // as in the roster
};

// A message for a person.
struct PhoneNotice {
  enum class Level : std::uint8_t {
    info = 0,
    warning = 1,
    end = 2,  // the server closes the connection: do not reconnect automatically
  };
  std::uint8_t level = 0;  // Level
  std::string text;
};

// Haptic pulse: a man of the rod has hit the ball.
struct PhonePulse {
  std::uint8_t rod = 0;       // 0, 1: index into PhoneState::rods
  std::uint8_t strength = 0;  // 255: max
  std::uint16_t ms = 0;       // at most kMaxPhonePulseMs
};
inline constexpr std::uint16_t kMaxPhonePulseMs = 200;

using PhoneReply = std::variant<PhoneState, PhoneNotice, PhonePulse>;

// Write one message. Return its size, or 0 if out is too small. Values are clamped to their field's
// range; values that are not finite become 0; texts are truncated to their limits. out:
// kMaxPhoneRequest, kMaxPhoneReply bytes.
std::size_t encode_phone(const PhoneRequest& request, std::span<std::byte> out);
std::size_t encode_phone(const PhoneReply& reply, std::span<std::byte> out);
// Return false unless version, kind, every range and the exact length are valid; the message is
// then unspecified but valid.
bool decode_phone(std::span<const std::byte> in, PhoneRequest& request);
bool decode_phone(std::span<const std::byte> in, PhoneReply& reply);

}  // namespace wire
