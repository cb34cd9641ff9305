// The only description of an input datagram. wire/description.h defines its elements.
#pragma once

#include <limits>

#include "wire/description.h"
#include "wire/input_datagram.h"

namespace wire {

inline constexpr std::uint64_t kInputMagic = 0x4E494653;  // "SFIN"
inline constexpr std::uint64_t kInputVersion = 1;

template <class Codec, class Rod>
void describe_input_rod(Codec& codec, Rod& rod) {
  codec.flag(Flag{"driven", "otherwise the other fields have no meaning"}, rod.driven);
  codec.fixed(Fixed{"slide", 20, 0x1p-18, "m", "target, along the rod"}, rod.slide);
  codec.wrapped(Wrapped{"angle", 32, "target, about the rod; full turns count"}, rod.angle);
  codec.fixed(Fixed{"slide_rate", 16, 0x1p-9, "m/s", ""}, rod.slide_rate);
  codec.fixed(Fixed{"angle_rate", 16, 0x1p-7, "rad/s", ""}, rod.angle_rate);
}

template <class Codec, class I>
void describe_input(Codec& codec, I& input) {
  constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
  codec.constant(Constant{"magic", 32, kInputMagic, "bytes \"SFIN\""});
  codec.constant(Constant{"version", 16, kInputVersion, ""});
  codec.layout_hash(LayoutHash{"layout_hash", "of this table"});
  codec.integer(Integer{"session", 64, kAny, "", "the server's, from Welcome"}, input.session);
  codec.integer(Integer{"token", 64, kAny, "", "the client's secret, from Welcome"}, input.token);
  codec.integer(Integer{"sequence", 32, std::numeric_limits<std::uint32_t>::max(), "",
                        "older ones are dropped"},
                input.sequence);
  codec.array(Group{"rods", "from -x to +x"}, input.rods,
              [&](auto& rod) { describe_input_rod(codec, rod); });
  codec.checksum(Checksum{"crc", ""});
}

}  // namespace wire
