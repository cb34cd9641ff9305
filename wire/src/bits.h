// Packs bits into bytes and unpacks them, lowest bit first, bounds-checked with a sticky error:
// after an error, writes are dropped and reads return 0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace wire {

class BitWriter {
 public:
  explicit BitWriter(std::span<std::byte> out) : out_(out) {}

  // bits <= 64; value < 2^bits.
  void put(std::uint64_t value, int bits) {
    window_ |= value << held_;
    held_ += bits;
    if (held_ < 64) return;
    put_word();
    held_ -= 64;
    // The bits that did not fit into the window; a shift by 64 would not give 0.
    window_ = held_ > 0 ? value >> (bits - held_) : 0;
  }

  void align() {
    for (; held_ > 0; held_ -= 8) {
      if (at_ == out_.size()) {
        failed_ = true;
      } else {
        out_[at_++] = static_cast<std::byte>(window_ & 0xFF);
      }
      window_ >>= 8;
    }
    held_ = 0;
  }

  // Precondition: aligned.
  void put_bytes(std::span<const std::byte> bytes) {
    if (bytes.size() > out_.size() - at_) {
      failed_ = true;
    } else if (!bytes.empty()) {
      std::memcpy(out_.data() + at_, bytes.data(), bytes.size());
      at_ += bytes.size();
    }
  }

  bool ok() const { return !failed_; }
  // Precondition: aligned.
  std::size_t size() const { return at_; }
  std::span<const std::byte> written() const { return out_.first(at_); }

 private:
  // Writes the full window, lowest byte first.
  void put_word() {
    if (out_.size() - at_ < 8) {
      failed_ = true;
      return;
    }
    std::array<std::byte, 8> bytes;  // one store on machines of any byte order
    for (int i = 0; i < 8; ++i) bytes[i] = static_cast<std::byte>(window_ >> 8 * i & 0xFF);
    std::memcpy(out_.data() + at_, bytes.data(), 8);
    at_ += 8;
  }

  std::span<std::byte> out_;
  std::size_t at_ = 0;
  std::uint64_t window_ = 0;  // the held_ lowest bits are pending; the others are 0
  int held_ = 0;              // < 64 between calls
  bool failed_ = false;
};

class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> in) : in_(in) {}

  // bits <= 64.
  std::uint64_t get(int bits) {
    if (bits <= 32) return get32(bits);
    const std::uint64_t low = get32(32);
    return low | get32(bits - 32) << 32;
  }

  // Skips to the next byte; false if a skipped bit was not 0.
  bool align() {
    const bool clean = window_ == 0;
    window_ = 0;
    held_ = 0;
    return clean;
  }

  // Precondition: aligned. Empty if fewer remain.
  std::span<const std::byte> get_bytes(std::uint64_t count) {
    if (failed_ || count > remaining()) {
      failed_ = true;
      return {};
    }
    at_ += count;
    return in_.subspan(at_ - count, count);
  }

  bool ok() const { return !failed_; }
  // Bytes read; the last one may be read in part.
  std::size_t consumed() const { return at_; }
  std::size_t remaining() const { return in_.size() - at_; }

 private:
  std::uint64_t get32(int bits) {
    while (held_ < bits) {
      if (failed_ || at_ == in_.size()) {
        failed_ = true;
        window_ = 0;
        held_ = 0;
        return 0;
      }
      window_ |= static_cast<std::uint64_t>(in_[at_++]) << held_;
      held_ += 8;
    }
    const std::uint64_t value = window_ & ((std::uint64_t{1} << bits) - 1);
    window_ >>= bits;
    held_ -= bits;
    return value;
  }

  std::span<const std::byte> in_;
  std::size_t at_ = 0;
  std::uint64_t window_ = 0;  // the held_ lowest bits are unread; the others are 0
  int held_ = 0;              // < 8 between calls
  bool failed_ = false;
};

}  // namespace wire
