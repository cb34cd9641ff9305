// Sealed bytes: what goes over a network is encrypted and authenticated, each direction under a key
// of its own, each piece under a number that is never used twice. ChaCha20-Poly1305 as RFC 8439 has
// it, by libsodium (crypto_aead_chacha20poly1305_ietf).
//
// A sealed datagram:
//   offset  size  field
//   0       4     id of the key: the client's, from Welcome; 0 for a multicast group's
//   4       8     counter: rises with each datagram of the key
//   12      n     the datagram, encrypted
//   12 + n  16    tag over all before it
// The nonce is four zero bytes and the counter; the first 12 bytes are authenticated, not
// encrypted.
//
// A sealed stream is a sequence of frames: u32 length of what follows (17 to kMaxSealedFrame), then
// the encrypted bytes, then the tag; the counter is the frame's number, from 0, and is not sent.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace wire {

using SealKey = std::array<std::byte, 32>;

inline constexpr std::size_t kSealHead = 12;
inline constexpr std::size_t kSealTag = 16;
inline constexpr std::size_t kSealBytes = kSealHead + kSealTag;  // a sealed datagram is longer by

// Writes the sealed datagram; returns its size, or 0 if out is too small. counter: never twice with
// one key, since two datagrams under one nonce give away both.
std::size_t seal_datagram(const SealKey& key, std::uint32_t id, std::uint64_t counter,
                          std::span<const std::byte> plain, std::span<std::byte> out);

enum class SealVerdict : std::uint8_t {
  good,
  malformed,  // too short or too long
  foreign,    // another key's
  replayed,   // was taken before, or is older than the window
  forged,     // the tag is wrong
};

// Takes each datagram of a key once, in any order within the window. The cheap checks come first:
// a flood of garbage costs a comparison each.
class DatagramOpener {
 public:
  // Datagrams further behind the newest than this are refused: a second of snapshots.
  static constexpr std::uint64_t kWindow = 1024;

  DatagramOpener() = default;  // opens nothing
  DatagramOpener(const SealKey& key, std::uint32_t id) : key_(key), id_(id), usable_(true) {}

  // From now on opens what this key and id seal. The window of a key that stays is kept: what was
  // taken before is not taken again.
  void use(const SealKey& key, std::uint32_t id);

  // good: the datagram is the first `size` bytes of plain. Else plain is unspecified.
  SealVerdict open(std::span<const std::byte> sealed, std::span<std::byte> plain,
                   std::size_t& size);

 private:
  bool taken(std::uint64_t counter) const;
  void take(std::uint64_t counter);

  SealKey key_{};
  std::uint32_t id_ = 0;
  bool usable_ = false, any_ = false;
  std::uint64_t newest_ = 0;
  std::bitset<kWindow> seen_;  // by counter modulo the window
};

inline constexpr std::size_t kMaxSealedFrame = 128 * 1024;

// One direction of a sealed stream.
class StreamSealer {
 public:
  explicit StreamSealer(const SealKey& key) : key_(key) {}
  // Appends the frames for these bytes.
  void seal(std::span<const std::byte> plain, std::vector<std::byte>& out);

 private:
  SealKey key_;
  std::uint64_t frame_ = 0;
};

class StreamOpener {
 public:
  explicit StreamOpener(const SealKey& key) : key_(key) {}
  // Takes bytes of the stream in any pieces, and appends what they held. False, for good, when a
  // frame is no frame of this key in its place.
  bool open(std::span<const std::byte> bytes, std::vector<std::byte>& plain);

 private:
  SealKey key_;
  std::uint64_t frame_ = 0;
  std::vector<std::byte> waiting_;  // an incomplete frame
  bool broken_ = false;
};

}  // namespace wire
