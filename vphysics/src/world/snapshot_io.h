// Snapshots as a sequence of u64: writing, and reading with a check of every value.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "world/digest.h"
#include "world/validate.h"

namespace vp {

inline constexpr std::uint64_t kSnapshotMagic = 0x31534359'48505650u;  // "PVPHYCS1"
inline constexpr std::uint64_t kSnapshotFormat = 15;

template <class Sink>
void put(Sink& sink, double x) {
  sink.u64(std::bit_cast<std::uint64_t>(x));
}
template <class Sink>
void put(Sink& sink, const Vec3& a) {
  put(sink, a.x);
  put(sink, a.y);
  put(sink, a.z);
}
template <class Sink>
void put_two(Sink& sink, std::uint32_t high, std::uint32_t low) {
  sink.u64((std::uint64_t{high} << 32) | low);
}
template <class Sink>
void put_two(Sink& sink, float high, float low) {
  put_two(sink, std::bit_cast<std::uint32_t>(high), std::bit_cast<std::uint32_t>(low));
}

// Reads u64 and digests them. Fails permanently if the bytes end or a value is out of range.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::uint64_t u64() {
    std::uint64_t w = 0;
    if (bytes_.size() < sizeof w) {
      ok_ = false;
      return 0;
    }
    std::memcpy(&w, bytes_.data(), sizeof w);
    bytes_ = bytes_.subspan(sizeof w);
    digest_ = mixed(digest_, w);
    return w;
  }
  double number() {
    const double x = std::bit_cast<double>(u64());
    check(std::isfinite(x));
    return x;
  }
  double bounded() {
    const double x = number();
    check(in_range(x));
    return x;
  }
  Vec3 vector() {
    const double x = bounded(), y = bounded(), z = bounded();
    return {x, y, z};
  }
  Vec3 finite_vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  // Rounding may have made it larger than the limit of the call that set it.
  Vec3 nearly_bounded_vector() {
    const Vec3 a = finite_vector();
    check(nearly_in_range(0.999 * a));
    return a;
  }
  struct Two {
    std::uint32_t high, low;
  };
  Two two() {
    const std::uint64_t w = u64();
    return {static_cast<std::uint32_t>(w >> 32), static_cast<std::uint32_t>(w)};
  }
  struct TwoFloats {
    float high, low;
  };
  TwoFloats two_floats() {
    const Two w = two();
    const TwoFloats f{std::bit_cast<float>(w.high), std::bit_cast<float>(w.low)};
    check(std::isfinite(f.high) && std::isfinite(f.low));
    return f;
  }
  // An index below the limit.
  std::uint32_t index(std::uint64_t limit) {
    const std::uint64_t w = u64();
    check(w < limit);
    return ok_ ? static_cast<std::uint32_t>(w) : 0;
  }
  // Number of the items that follow, of at least u64s_each u64 each: no more than the bytes hold.
  std::size_t count(std::size_t u64s_each) {
    const std::uint64_t n = u64();
    check(n <= bytes_.size() / (u64s_each * sizeof(std::uint64_t)));
    return ok_ ? static_cast<std::size_t>(n) : 0;
  }
  void check(bool condition) { ok_ = ok_ && condition; }
  bool ok() const { return ok_; }
  bool at_end() const { return bytes_.empty(); }
  // Digest of all u64 so far, as in a snapshot's last u64.
  std::uint64_t digest() const { return digest_; }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t digest_ = kSnapshotMagic;
  bool ok_ = true;
};

}  // namespace vp
