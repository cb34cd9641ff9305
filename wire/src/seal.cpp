#include "wire/seal.h"

#include <sodium.h>

#include <algorithm>

#include "sodium_bytes.h"

namespace wire {
namespace {

static_assert(crypto_aead_chacha20poly1305_ietf_KEYBYTES == sizeof(SealKey));
static_assert(crypto_aead_chacha20poly1305_ietf_ABYTES == kSealTag);

constexpr std::size_t kLengthBytes = 4;
// Max plain bytes of one frame; longer messages use several frames.
constexpr std::size_t kMaxPlainFrame = kMaxSealedFrame - kSealTag;

using Nonce = std::array<unsigned char, crypto_aead_chacha20poly1305_ietf_NPUBBYTES>;

template <class Integer>
void put(Integer value, std::byte* out) {
  for (std::size_t i = 0; i < sizeof value; ++i) out[i] = static_cast<std::byte>(value >> 8 * i);
}
template <class Integer>
Integer get(const std::byte* in) {
  Integer value = 0;
  for (std::size_t i = 0; i < sizeof value; ++i) value |= static_cast<Integer>(in[i]) << 8 * i;
  return value;
}

Nonce nonce_of(std::uint64_t counter) {
  Nonce nonce{};
  for (std::size_t i = 0; i < 8; ++i) nonce[4 + i] = static_cast<unsigned char>(counter >> 8 * i);
  return nonce;
}

// Lets libsodium select its implementation for this processor once; otherwise it uses the portable
// one.
void prepare() {
  [[maybe_unused]] static const int ready = ::sodium_init();
}

void encrypt(const SealKey& key, std::uint64_t counter, std::span<const std::byte> head,
             std::span<const std::byte> plain, std::byte* out) {
  prepare();
  const Nonce nonce = nonce_of(counter);
  ::crypto_aead_chacha20poly1305_ietf_encrypt(raw(out), nullptr, raw(plain.data()), plain.size(),
                                              raw(head.data()), head.size(), nullptr, nonce.data(),
                                              raw(key.data()));
}

bool decrypt(const SealKey& key, std::uint64_t counter, std::span<const std::byte> head,
             std::span<const std::byte> sealed, std::byte* out) {
  prepare();
  const Nonce nonce = nonce_of(counter);
  return ::crypto_aead_chacha20poly1305_ietf_decrypt(raw(out), nullptr, nullptr, raw(sealed.data()),
                                                     sealed.size(), raw(head.data()), head.size(),
                                                     nonce.data(), raw(key.data())) == 0;
}

}  // namespace

std::size_t seal_datagram(const SealKey& key, std::uint32_t id, std::uint64_t counter,
                          std::span<const std::byte> plain, std::span<std::byte> out) {
  const std::size_t size = plain.size() + kSealBytes;
  if (out.size() < size) return 0;
  put(id, out.data());
  put(counter, out.data() + 4);
  encrypt(key, counter, out.first(kSealHead), plain, out.data() + kSealHead);
  return size;
}

void DatagramOpener::use(const SealKey& key, std::uint32_t id) {
  if (!usable_ || key != key_ || id != id_) *this = DatagramOpener(key, id);
}

bool DatagramOpener::taken(std::uint64_t counter) const {
  if (!any_ || counter > newest_) return false;
  return newest_ - counter >= kWindow || seen_[counter % kWindow];
}

void DatagramOpener::take(std::uint64_t counter) {
  if (!any_ || counter > newest_) {
    if (!any_ || counter - newest_ >= kWindow) {
      seen_.reset();
    } else {
      for (std::uint64_t i = newest_ + 1; i != counter; ++i) seen_.reset(i % kWindow);
    }
    newest_ = counter;
    any_ = true;
  }
  seen_.set(counter % kWindow);
}

SealVerdict DatagramOpener::open(std::span<const std::byte> sealed, std::span<std::byte> plain,
                                 std::size_t& size) {
  if (sealed.size() < kSealBytes || sealed.size() - kSealBytes > plain.size()) {
    return SealVerdict::malformed;
  }
  if (!usable_ || get<std::uint32_t>(sealed.data()) != id_) return SealVerdict::foreign;
  const auto counter = get<std::uint64_t>(sealed.data() + 4);
  if (taken(counter)) return SealVerdict::replayed;
  const auto head = sealed.first(kSealHead), body = sealed.subspan(kSealHead);
  if (!decrypt(key_, counter, head, body, plain.data())) return SealVerdict::forged;
  take(counter);  // only after authentication: a forged counter must not move the window
  size = sealed.size() - kSealBytes;
  return SealVerdict::good;
}

void StreamSealer::seal(std::span<const std::byte> plain, std::vector<std::byte>& out) {
  while (!plain.empty()) {
    const auto part = plain.first(std::min(plain.size(), kMaxPlainFrame));
    plain = plain.subspan(part.size());
    const std::size_t at = out.size();
    out.resize(at + kLengthBytes + part.size() + kSealTag);
    put(static_cast<std::uint32_t>(part.size() + kSealTag), out.data() + at);
    encrypt(key_, frame_++, std::span(out).subspan(at, kLengthBytes), part,
            out.data() + at + kLengthBytes);
  }
}

bool StreamOpener::open(std::span<const std::byte> bytes, std::vector<std::byte>& plain) {
  if (broken_) return false;
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  std::size_t done = 0;
  while (waiting_.size() - done >= kLengthBytes) {
    const auto length = get<std::uint32_t>(waiting_.data() + done);
    if (length <= kSealTag || length > kMaxSealedFrame) {
      broken_ = true;
      return false;
    }
    if (waiting_.size() - done - kLengthBytes < length) break;
    const auto head = std::span(waiting_).subspan(done, kLengthBytes);
    const auto sealed = std::span(waiting_).subspan(done + kLengthBytes, length);
    const std::size_t at = plain.size();
    plain.resize(at + length - kSealTag);
    if (!decrypt(key_, frame_++, head, sealed, plain.data() + at)) {
      plain.resize(at);
      broken_ = true;
      return false;
    }
    done += kLengthBytes + length;
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
  return true;
}

}  // namespace wire
