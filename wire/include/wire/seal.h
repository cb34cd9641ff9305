// Sealed bytes: network data is encrypted and authenticated. Each direction has its own key, and
// each piece has a number that is never reused. ChaCha20-Poly1305 as in RFC 8439, by libsodium
// (crypto_aead_chacha20poly1305_ietf).
//
// A sealed datagram:
//   offset  size  field
//   0       4     id of the key: the client's, from Welcome; 0 for a multicast group
//   4       8     counter: increases with each datagram of the key
//   12      n     the datagram, encrypted
//   12 + n  16    tag over all bytes before it
// The nonce is four zero bytes and the counter. The first 12 bytes are authenticated, but not
// encrypted.
//
// A sealed stream is a sequence of frames: u32 length of the rest (17 to kMaxSealedFrame), then the
// encrypted bytes, then the tag. The counter is the frame's number, from 0, and is not sent.
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
inline constexpr std::size_t kSealBytes = kSealHead + kSealTag;  // added to the size of a datagram

// Writes the sealed datagram. Returns its size, or 0 if out is too small. counter: must never
// repeat under one key, since two datagrams with one nonce reveal both.
std::size_t seal_datagram(const SealKey& key, std::uint32_t id, std::uint64_t counter,
                          std::span<const std::byte> plain, std::span<std::byte> out);

enum class SealVerdict : std::uint8_t {
  good,
  malformed,  // too short or too long
  foreign,    // of another key
  replayed,   // received before, or older than the window
  forged,     // the tag is wrong
};

// Accepts each datagram of a key once, in any order within the window. The cheap checks come first:
// a flood of garbage costs one comparison per datagram.
class DatagramOpener {
 public:
  // Datagrams older than the newest by more than this are rejected: a second of snapshots.
  static constexpr std::uint64_t kWindow = 1024;

  DatagramOpener() = default;  // opens nothing
  DatagramOpener(const SealKey& key, std::uint32_t id) : key_(key), id_(id), usable_(true) {}

  // Opens datagrams of this key and id from now on. If the key is unchanged, the window is kept, so
  // that datagrams received before are rejected as replays.
  void use(const SealKey& key, std::uint32_t id);

  // good: the first `size` bytes of plain are the datagram. Otherwise plain is unspecified.
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
  // Takes the stream's bytes in pieces of any size, and appends the decrypted bytes. Returns false,
  // from then on, if a frame is not the next frame of this key.
  bool open(std::span<const std::byte> bytes, std::vector<std::byte>& plain);

 private:
  SealKey key_;
  std::uint64_t frame_ = 0;
  std::vector<std::byte> waiting_;  // an incomplete frame
  bool broken_ = false;
};

}  // namespace wire
