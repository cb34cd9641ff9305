// The elements in which messages are described. A description is a function template
//
//   template <class Codec, class Message> void describe_x(Codec& codec, Message& message)
//
// that passes each field, with the data below, to a codec, in wire order. The codecs are an encoder
// and a decoder (src/codec.h), and a lister (src/layout.h). The lister's output defines the layout
// hash and docs/protocol.md; a reader in another language could be generated from it.
//
// Bit order: the lowest bit of each byte first, bytes in order. A field of up to 64 bits is
// therefore little endian at any alignment.
#pragma once

#include <cstdint>

namespace wire {

// Always this value; any other value is rejected.
struct Constant {
  const char* name;
  int bits;
  std::uint64_t value;
  const char* meaning;
};

// 32 bits: FNV-1a over the names, bits and ranges of the complete description.
struct LayoutHash {
  const char* name;
  const char* meaning;
};

// 0..max.
struct Integer {
  const char* name;
  int bits;
  std::uint64_t max;
  const char* unit;
  const char* meaning;
};

struct Flag {
  const char* name;
  const char* meaning;
};

// value = step * (code - zero). Signed: zero = 2^(bits-1) - 1, and the code with all bits set is
// rejected, so that 0 is exact and the range is symmetric. Unsigned: zero = 0. Steps are powers of
// two, so that every language and compiler decodes to the same bits.
struct Fixed {
  const char* name;
  int bits;
  double step;
  const char* unit;
  const char* meaning;
  bool is_signed = true;

  constexpr std::int64_t zero() const {
    return is_signed ? (std::int64_t{1} << (bits - 1)) - 1 : 0;
  }
  constexpr std::int64_t max_code() const {
    return (std::int64_t{1} << bits) - (is_signed ? 2 : 1);
  }
  constexpr double low() const { return zero() == 0 ? 0 : -step * static_cast<double>(zero()); }
  constexpr double high() const { return step * static_cast<double>(max_code() - zero()); }
};

// An angle [rad] in units of 1/65536 revolution, modulo 2^bits units, decoded to the interval
// around 0. The code is two's complement.
struct Wrapped {
  const char* name;
  int bits;
  const char* meaning;
};
inline constexpr double kTurn = 6.283185307179586;       // [rad]
inline constexpr double kWrappedStep = kTurn / 65536.0;  // [rad]

// A unit quaternion: the index of its largest component (2 bits), then the three others in order as
// signed codes of `bits` bits over +-1/sqrt(2), coded like Fixed. The largest component is made
// positive. Rejected if the decoded largest component, sqrt(1 - sum of squares), is smaller than
// another one by more than 3 steps.
struct Rotation {
  const char* name;
  int bits;
  const char* meaning;

  constexpr std::int64_t zero() const { return (std::int64_t{1} << (bits - 1)) - 1; }
  constexpr double step() const { return 0.7071067811865476 / static_cast<double>(zero()); }
};

// Groups of 7 bits, lowest first; bit 7 of each byte says that another follows. Range 0..max.
// Over-long encodings are rejected.
struct Varint {
  const char* name;
  std::uint64_t max;
  const char* unit;
  const char* meaning;
};

// A signed number v, |v| <= limit, encoded as the Varint of (v << 1) ^ (v >> 63).
struct Delta {
  const char* name;
  std::int64_t limit;
  const char* unit;
  const char* meaning;
};

// A fixed number of equal elements, or one nested structure.
struct Group {
  const char* name;
  const char* meaning;
};

// A count of `bits` bits, 0..max, then that many elements.
struct List {
  const char* name;
  int bits;
  std::uint64_t max;
  const char* meaning;
};

// A Varint length, then that many bytes.
struct Bytes {
  const char* name;
  std::uint64_t max;
  const char* meaning;
};

// Like Bytes, holding UTF-8 without control characters.
struct Text {
  const char* name;
  std::uint64_t max;
  const char* meaning;
};

// Zero bits up to the next byte, then the CRC-32 (as in zlib) of all bytes before it. No bytes may
// follow.
struct Checksum {
  const char* name;
  const char* meaning;
};

}  // namespace wire
