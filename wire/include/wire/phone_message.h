// What a phone that plays as a pair of rods and the server say to each other: one message in each
// binary WebSocket message, both ways. What each holds is described once, in
// wire/phone_description.h; all fields are of whole bytes, so that a page reads them with a
// DataView.
//
// Frame: the table's (foosball/table.h): a slide is along +y, an angle a right-handed turn about
// +y; at 0 the men hang straight down.
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
// Bytes of the longest message: more from a phone ends its connection.
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
  std::uint64_t session = 0;  // with ticket: of the PhoneState before, to have the same seat
  std::uint64_t ticket = 0;   // again; 0: a new one
  std::string name;           // at most kMaxPhoneName bytes of UTF-8
};

// These rods from now on. The answer is a PhoneState, or a PhoneNotice that says why not.
struct PhoneClaim {
  std::uint8_t team = 0;                      // 0, 1
  std::uint8_t pair = number(RodPair::none);  // RodPair
};

struct PhoneRod {
  bool driven = false;                   // else the other fields say nothing
  float slide = 0;                       // wanted [m]
  double angle = 0;                      // wanted [rad], full turns count; wraps at 65536 turns
  float slide_rate = 0, angle_rate = 0;  // [m/s], [rad/s]
};

// On every change, and at least 20 a second.
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

// After the hello, and after each change of who has which rods.
struct PhoneState {
  std::uint64_t session = 0, ticket = 0;         // for the next PhoneHello
  std::uint8_t team = 0;                         // 0, 1; of no meaning without a pair
  std::uint8_t pair = number(RodPair::none);     // RodPair, that this phone has
  std::uint8_t free = 0;                         // pairs to be had: bit 2 * team + pair
  std::array<PhoneRodPlace, kPhoneRods> rods{};  // of the pair, as PhoneInput::rods
  std::string name;                              // as the roster has it
};

// A person should read it.
struct PhoneNotice {
  enum class Level : std::uint8_t {
    info = 0,
    warning = 1,
    end = 2,  // the server closes the connection: it is no use to connect again by oneself
  };
  std::uint8_t level = 0;  // Level
  std::string text;
};

// The rod shakes: a man of it has hit the ball.
struct PhonePulse {
  std::uint8_t rod = 0;       // 0, 1: index into PhoneState::rods
  std::uint8_t strength = 0;  // 255: the most
  std::uint16_t ms = 0;       // at most kMaxPhonePulseMs
};
inline constexpr std::uint16_t kMaxPhonePulseMs = 200;

using PhoneReply = std::variant<PhoneState, PhoneNotice, PhonePulse>;

// Write one message; return its size, or 0 if out is smaller than that. Values out of a field's
// range are clamped, those not finite are 0; texts are cut to their caps. out: kMaxPhoneRequest,
// kMaxPhoneReply bytes.
std::size_t encode_phone(const PhoneRequest& request, std::span<std::byte> out);
std::size_t encode_phone(const PhoneReply& reply, std::span<std::byte> out);
// False unless version, kind, every range and the exact length hold; the message is then
// unspecified but valid.
bool decode_phone(std::span<const std::byte> in, PhoneRequest& request);
bool decode_phone(std::span<const std::byte> in, PhoneReply& reply);

}  // namespace wire
