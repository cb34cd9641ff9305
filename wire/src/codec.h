// The encoder and the decoder: codecs for the descriptions (wire/description.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "bits.h"
#include "crc32.h"
#include "quantise.h"
#include "wire/description.h"
#include "wire/text.h"

namespace wire {

// Operations that only order the fields and have no bits of their own; shared by both codecs.
class Structure {
 public:
  template <class Body>
  void group(const Group&, Body body) {
    body();
  }
  template <class Body>
  void when(const Group&, bool present, Body body) {
    if (present) body();
  }
  template <class Elements, class Body>
  void array(const Group&, Elements& elements, Body body) {
    for (auto& element : elements) body(element);
  }
};

// Writes a message. The output is valid for any values: they are clamped to their ranges.
class Encoder : public Structure {
 public:
  Encoder(std::span<std::byte> out, std::uint32_t layout) : bits_(out), layout_(layout) {}

  // Bytes written; 0 if they did not fit.
  std::size_t finish() {
    bits_.align();
    return bits_.ok() ? bits_.size() : 0;
  }

  void constant(const Constant& f) { bits_.put(f.value, f.bits); }
  void layout_hash(const LayoutHash&) { bits_.put(layout_, 32); }

  template <class T>
  void integer(const Integer& f, const T& value) {
    bits_.put(std::min(not_negative(value), f.max), f.bits);
  }
  void flag(const Flag&, bool value) { bits_.put(value, 1); }

  void fixed(const Fixed& f, double value) { bits_.put(fixed_code(f, value), f.bits); }
  void vector(const Fixed& f, const std::array<float, 3>& v) {
    for (const float value : v) fixed(f, static_cast<double>(value));
  }
  void wrapped(const Wrapped& f, double angle) { bits_.put(wrapped_code(f, angle), f.bits); }
  void rotation(const Rotation& f, const std::array<float, 4>& q) {
    const RotationCode code = rotation_code(f, q);
    bits_.put(code.largest, 2);
    for (const std::uint64_t other : code.others) bits_.put(other, f.bits);
  }

  template <class T>
  void varint(const Varint& f, const T& value) {
    put_varint(std::min(not_negative(value), f.max));
  }
  void delta(const Delta& f, std::int64_t value) {
    value = std::clamp(value, -f.limit, f.limit);
    put_varint(static_cast<std::uint64_t>(value) << 1 ^ static_cast<std::uint64_t>(value >> 63));
  }

  template <class T, class Body>
  void list(const List& f, const std::vector<T>& elements, Body body) {
    const std::size_t count = std::min<std::size_t>(elements.size(), f.max);
    bits_.put(count, f.bits);
    for (std::size_t i = 0; i < count; ++i) body(elements[i]);
  }
  void bytes(const Bytes& f, const std::vector<std::byte>& value) {
    const std::size_t count = std::min<std::size_t>(value.size(), f.max);
    put_varint(count);
    align();
    bits_.put_bytes(std::span(value).first(count));
  }
  void text(const Text& f, const std::string& value) {
    const std::string clean = clean_text(value, f.max);
    put_varint(clean.size());
    align();
    bits_.put_bytes(std::as_bytes(std::span(clean)));
  }
  void align() { bits_.align(); }
  void checksum(const Checksum&) {
    align();
    bits_.put(crc32(bits_.written()), 32);
  }

 private:
  template <class T>
  static std::uint64_t not_negative(T value) {
    if constexpr (std::is_signed_v<T>) {
      return value < 0 ? 0 : static_cast<std::uint64_t>(value);
    } else {
      return value;
    }
  }
  void put_varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bits_.put((value & 0x7F) | 0x80, 8);
    bits_.put(value, 8);
  }

  BitWriter bits_;
  std::uint32_t layout_;
};

// Reads a message. Keeps the first error; after it, all fields read as 0. Check ok() once, at the
// end.
class Decoder : public Structure {
 public:
  Decoder(std::span<const std::byte> in, std::uint32_t layout)
      : in_(in), bits_(in), layout_(layout) {}

  bool ok() const { return bad_ == nullptr; }
  // Name of the first field that was missing or out of range.
  const char* bad_field() const { return bad_; }
  // Complete bytes read. Precondition: aligned.
  std::size_t consumed() { return bits_.consumed(); }
  bool at_end() { return ok() && bits_.align() && bits_.remaining() == 0; }

  void constant(const Constant& f) { require(get(f.bits) == f.value, f.name); }
  void layout_hash(const LayoutHash& f) { require(get(32) == layout_, f.name); }

  template <class T>
  void integer(const Integer& f, T& value) {
    value = static_cast<T>(within(get(f.bits), f.max, f.name));
  }
  void flag(const Flag& f, bool& value) {
    value = get(1) != 0;
    require(true, f.name);
  }

  template <class Real>
  void fixed(const Fixed& f, Real& value) {
    const std::uint64_t zero = static_cast<std::uint64_t>(f.zero());
    const std::uint64_t code = get(f.bits);
    require(code <= static_cast<std::uint64_t>(f.max_code()), f.name);
    value = static_cast<Real>(fixed_value(f, ok() ? code : zero));
  }
  void vector(const Fixed& f, std::array<float, 3>& v) {
    for (float& value : v) fixed(f, value);
  }
  template <class Real>
  void wrapped(const Wrapped& f, Real& angle) {
    angle = static_cast<Real>(wrapped_value(f, get(f.bits)));
    require(true, f.name);
  }
  void rotation(const Rotation& f, std::array<float, 4>& q) {
    RotationCode code;
    code.largest = get(2);
    for (std::uint64_t& other : code.others) other = get(f.bits);
    const bool valid = rotation_value(f, code, q);
    require(valid, f.name);
    if (!ok()) q = {0, 0, 0, 1};
  }

  template <class T>
  void varint(const Varint& f, T& value) {
    value = static_cast<T>(within(get_varint(f.name), f.max, f.name));
  }
  void delta(const Delta& f, std::int64_t& value) {
    const std::uint64_t code = get_varint(f.name);
    value = static_cast<std::int64_t>(code >> 1 ^ (0 - (code & 1)));
    require(-f.limit <= value && value <= f.limit, f.name);
    if (!ok()) value = 0;
  }

  template <class T, class Body>
  void list(const List& f, std::vector<T>& elements, Body body) {
    elements.resize(within(get(f.bits), f.max, f.name));
    for (T& element : elements) body(element);
  }
  void bytes(const Bytes& f, std::vector<std::byte>& value) {
    const std::uint64_t count = within(get_varint(f.name), f.max, f.name);
    align();
    const auto bytes = bits_.get_bytes(count);
    require(true, f.name);
    value.assign(bytes.begin(), bytes.end());
  }
  void text(const Text& f, std::string& value) {
    const std::uint64_t count = within(get_varint(f.name), f.max, f.name);
    align();
    const auto bytes = bits_.get_bytes(count);
    value.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    require(is_clean_text(value, f.max), f.name);
  }
  void align() { require(bits_.align(), "padding"); }
  void checksum(const Checksum& f) {
    align();
    const std::size_t covered = bits_.consumed();
    const std::uint64_t sum = get(32);
    require(ok() && sum == crc32(in_.first(covered)) && at_end(), f.name);
  }

 private:
  std::uint64_t get(int count) { return bits_.get(count); }

  void require(bool holds, const char* field) {
    if (bad_ == nullptr && (!holds || !bits_.ok())) bad_ = field;
  }
  std::uint64_t within(std::uint64_t value, std::uint64_t max, const char* field) {
    require(value <= max, field);
    return ok() ? value : 0;
  }
  std::uint64_t get_varint(const char* field) {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint64_t group = get(8);
      value |= (group & 0x7F) << shift;
      if (group < 0x80) {
        const bool shortest = group != 0 || shift == 0;
        require(shortest && (shift < 63 || group == 1), field);
        return value;
      }
    }
    require(false, field);
    return 0;
  }

  std::span<const std::byte> in_;
  BitReader bits_;
  std::uint32_t layout_;
  const char* bad_ = nullptr;
};

}  // namespace wire
