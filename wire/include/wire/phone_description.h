// The only description of the phone's messages. wire/description.h defines its elements. Each
// message begins with the version and its kind. Kinds of the server have the highest bit set.
#pragma once

#include <limits>

#include "wire/description.h"
#include "wire/limits.h"
#include "wire/phone_message.h"

namespace wire {

enum class PhoneKind : std::uint8_t {
  hello = 1,
  claim = 2,
  input = 3,
  state = 0x81,
  notice = 0x82,
  pulse = 0x83,
};

template <class Codec>
void describe_phone_head(Codec& codec, PhoneKind kind) {
  codec.constant(Constant{"version", 8, kPhoneVersion, ""});
  codec.constant(Constant{"kind", 8, static_cast<std::uint64_t>(kind), ""});
}

template <class Codec, class Pair>
void describe_pair(Codec& codec, Pair& pair) {
  codec.integer(Integer{"pair", 8, kRodPairCount - 1, "",
                        "0 goalie and defence, 1 midfield and attack, 2 none"},
                pair);
}

inline constexpr std::uint64_t kAnyU64 = std::numeric_limits<std::uint64_t>::max();

template <class Codec, class M>
void describe_phone_hello(Codec& codec, M& hello) {
  describe_phone_head(codec, PhoneKind::hello);
  codec.integer(Integer{"session", 64, kAnyU64, "", "with ticket: of the last state"},
                hello.session);
  codec.integer(Integer{"ticket", 64, kAnyU64, "", "to get the same seat again; 0: a new one"},
                hello.ticket);
  codec.text(Text{"name", kMaxPhoneName, ""}, hello.name);
}

template <class Codec, class M>
void describe_phone_claim(Codec& codec, M& claim) {
  describe_phone_head(codec, PhoneKind::claim);
  codec.integer(Integer{"team", 8, kTeamCount - 1, "", ""}, claim.team);
  describe_pair(codec, claim.pair);
}

template <class Codec, class M>
void describe_phone_input(Codec& codec, M& input) {
  describe_phone_head(codec, PhoneKind::input);
  codec.integer(Integer{"sequence", 32, std::numeric_limits<std::uint32_t>::max(), "",
                        "older ones are dropped"},
                input.sequence);
  codec.array(Group{"rods", "of the pair, the one at -x first"}, input.rods, [&](auto& rod) {
    codec.integer(Integer{"driven", 8, 1, "", "0: the other fields have no meaning"}, rod.driven);
    codec.fixed(Fixed{"slide", 16, 0x1p-14, "m", "target, along the rod"}, rod.slide);
    codec.wrapped(Wrapped{"angle", 32, "target, about the rod; full turns count"}, rod.angle);
    codec.fixed(Fixed{"slide_rate", 16, 0x1p-9, "m/s", ""}, rod.slide_rate);
    codec.fixed(Fixed{"angle_rate", 16, 0x1p-7, "rad/s", ""}, rod.angle_rate);
  });
}

template <class Codec, class M>
void describe_phone_state(Codec& codec, M& state) {
  describe_phone_head(codec, PhoneKind::state);
  codec.integer(Integer{"session", 64, kAnyU64, "", "names this run of the server"}, state.session);
  codec.integer(Integer{"ticket", 64, kAnyU64, "", "the phone's secret"}, state.ticket);
  codec.integer(Integer{"team", 8, kTeamCount - 1, "", "of the pair"}, state.team);
  describe_pair(codec, state.pair);
  codec.integer(Integer{"free", 8, 15, "", "free pairs: bit 2 * team + pair"}, state.free);
  codec.array(Group{"rods", "of the pair, the one at -x first"}, state.rods, [&](auto& rod) {
    codec.integer(Integer{"line", 8, 3, "", "0 goalie .. 3 attack"}, rod.line);
    codec.integer(Integer{"men", 8, kMenOnRod, "", ""}, rod.men);
    codec.fixed(Fixed{"spacing", 16, 0x1p-14, "m", "between neighbours"}, rod.spacing);
    codec.fixed(Fixed{"slide_limit", 16, 0x1p-14, "m", "|slide| at most"}, rod.slide_limit);
  });
  codec.text(Text{"name", 64, "as in the roster"}, state.name);
}

template <class Codec, class M>
void describe_phone_notice(Codec& codec, M& notice) {
  describe_phone_head(codec, PhoneKind::notice);
  codec.integer(Integer{"level", 8, 2, "", "0 info, 1 warning, 2 the end of the connection"},
                notice.level);
  codec.text(Text{"text", kMaxPhoneText, ""}, notice.text);
}

template <class Codec, class M>
void describe_phone_pulse(Codec& codec, M& pulse) {
  describe_phone_head(codec, PhoneKind::pulse);
  codec.integer(Integer{"rod", 8, kPhoneRods - 1, "", "of the state's"}, pulse.rod);
  codec.integer(Integer{"strength", 8, 255, "", "255: the maximum"}, pulse.strength);
  codec.integer(Integer{"ms", 16, kMaxPhonePulseMs, "ms", ""}, pulse.ms);
}

}  // namespace wire
