// Little-endian bytes of a saved match. Writer and reader have the same interface, so one function
// that visits every field describes both directions. The reader checks bounds. Its first error is
// sticky; callers check ok() once at the end.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace foosball {

// Out: any type with push_back(), such as a vector of bytes.
template <class Out>
class ByteWriter {
 public:
  explicit ByteWriter(Out& out) : out_(out) {}

  template <class T>
  void choice(const T& x, int /*end*/) {
    out_.push_back(static_cast<std::byte>(x));
  }
  void flag(const bool& x) { choice(x, 2); }
  void man(const int& x, int end) { choice(x + 1, end + 1); }
  void any(const std::uint64_t& x) {
    for (int i = 0; i < 8; ++i) out_.push_back(static_cast<std::byte>(x >> (8 * i)));
  }
  void count(const std::uint64_t& x, std::uint64_t /*most*/) { any(x); }
  void real(const double& x, double /*low*/, double /*high*/) {
    any(std::bit_cast<std::uint64_t>(x));
  }

 private:
  Out& out_;
};

// FNV-1a of the bytes. It needs no buffer, because the recorder hashes between two ticks.
struct ByteHash {
  void push_back(std::byte b) {
    value = (value ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3u;
  }
  std::uint64_t value = 0xcbf29ce484222325u;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> in) : in_(in) {}
  bool ok() const { return ok_; }
  std::span<const std::byte> rest() const { return in_; }

  // A bool, an integer or an enum in [0, end), end <= 256.
  template <class T>
  void choice(T& x, int end) {
    const auto value = static_cast<int>(take(1));
    if (require(value < end)) x = static_cast<T>(value);
  }
  void flag(bool& x) { choice(x, 2); }
  // An index in [0, end), or -1 for none.
  void man(int& x, int end) {
    int above = 0;
    choice(above, end + 1);
    x = above - 1;
  }
  void any(std::uint64_t& x) { x = take(8); }
  // An integer in [0, most].
  void count(std::uint64_t& x, std::uint64_t max) {
    const std::uint64_t value = take(8);
    if (require(value <= max)) x = value;
  }
  // A number in [low, high]; NaN is an error.
  void real(double& x, double low, double high) {
    const auto value = std::bit_cast<double>(take(8));
    if (require(value >= low && value <= high)) x = value;
  }
  bool require(bool condition) {
    ok_ = ok_ && condition;
    return ok_;
  }

 private:
  std::uint64_t take(std::size_t size) {
    if (!require(in_.size() >= size)) return 0;
    std::uint64_t x = 0;
    for (std::size_t i = 0; i < size; ++i) {
      x |= std::uint64_t{std::to_integer<std::uint8_t>(in_[i])} << (8 * i);
    }
    in_ = in_.subspan(size);
    return x;
  }

  std::span<const std::byte> in_;
  bool ok_ = true;
};

}  // namespace foosball
