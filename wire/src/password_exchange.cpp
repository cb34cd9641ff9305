#include "wire/password_exchange.h"

#include <sodium.h>

#include <algorithm>
#include <vector>

#include "sodium_bytes.h"

namespace wire {
namespace {

constexpr char kDsi[] = "CPaceRistretto255";
constexpr char kDsiIsk[] = "CPaceRistretto255_ISK";
constexpr std::size_t kHashBlock = 128;  // of SHA-512: zeros pad the password to one block

using Bytes = std::vector<std::byte>;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

// Appends the length, 7 bits per byte, lowest first, and then the bytes: prepend_len of the draft.
void append_with_length(std::span<const std::byte> bytes, Bytes& out) {
  std::size_t length = bytes.size();
  for (; length >= 128; length >>= 7) out.push_back(static_cast<std::byte>(length % 128 + 128));
  out.push_back(static_cast<std::byte>(length));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

std::array<std::byte, 64> sha512(const Bytes& bytes) {
  std::array<std::byte, 64> hash;
  ::crypto_hash_sha512(raw(hash.data()), raw(bytes.data()), bytes.size());
  return hash;
}

std::array<std::byte, 32> generator(const std::string& password, const std::string& channel,
                                    const ExchangeSid& sid) {
  Bytes head;
  append_with_length(bytes_of(kDsi), head);
  append_with_length(bytes_of(password), head);
  const std::size_t used = head.size() + 1;  // plus the length byte of the padding
  const Bytes zeros(used < kHashBlock ? kHashBlock - used : 0);
  append_with_length(zeros, head);
  append_with_length(bytes_of(channel), head);
  append_with_length(sid, head);
  const auto hash = sha512(head);
  ::sodium_memzero(head.data(), head.size());
  std::array<std::byte, 32> point;
  ::crypto_core_ristretto255_from_hash(raw(point.data()), raw(hash.data()));
  return point;
}

std::array<std::byte, 32> random_scalar() {
  [[maybe_unused]] static const int ready = ::sodium_init();
  std::array<std::byte, 32> scalar;
  ::crypto_core_ristretto255_scalar_random(raw(scalar.data()));
  return scalar;
}

}  // namespace

PasswordExchange::PasswordExchange(Side side, const std::string& password,
                                   const std::string& channel, const ExchangeSid& sid)
    : PasswordExchange(side, password, channel, sid, random_scalar()) {}

PasswordExchange::PasswordExchange(Side side, const std::string& password,
                                   const std::string& channel, const ExchangeSid& sid,
                                   const std::array<std::byte, 32>& scalar)
    : side_(side), sid_(sid), scalar_(scalar) {
  const auto g = generator(password, channel, sid);
  // Fails only for the neutral element, which the hash never yields. The share is then zero, and
  // the peer rejects it.
  if (::crypto_scalarmult_ristretto255(raw(share_.data()), raw(scalar_.data()), raw(g.data())) !=
      0) {
    share_ = {};
  }
}

PasswordExchange::~PasswordExchange() {
  ::sodium_memzero(scalar_.data(), scalar_.size());
}

std::optional<ExchangeSecret> PasswordExchange::secret(const ExchangeShare& others,
                                                       const std::string& client_data,
                                                       const std::string& server_data) const {
  std::array<std::byte, 32> k{};
  if (::crypto_core_ristretto255_is_valid_point(raw(others.data())) != 1 ||
      ::crypto_scalarmult_ristretto255(raw(k.data()), raw(scalar_.data()), raw(others.data())) !=
          0) {
    return std::nullopt;
  }
  const bool client = side_ == Side::client;
  Bytes text;
  append_with_length(bytes_of(kDsiIsk), text);
  append_with_length(sid_, text);
  append_with_length(k, text);
  append_with_length(client ? share_ : others, text);
  append_with_length(bytes_of(client_data), text);
  append_with_length(client ? others : share_, text);
  append_with_length(bytes_of(server_data), text);
  const auto isk = sha512(text);
  ::sodium_memzero(text.data(), text.size());
  ::sodium_memzero(k.data(), k.size());
  return isk;
}

const char* exchange_channel(bool host) {
  return host ? "Space Foosball 2, host" : "Space Foosball 2, guest";
}

StreamKeys stream_keys(const ExchangeSecret& secret) {
  // crypto_kdf takes 32 bytes; the 64-byte secret is hashed to that size.
  std::array<std::byte, crypto_kdf_KEYBYTES> root;
  ::crypto_generichash(raw(root.data()), root.size(), raw(secret.data()), secret.size(), nullptr,
                       0);
  StreamKeys keys;
  constexpr char kContext[] = "SFstream";
  static_assert(sizeof kContext == crypto_kdf_CONTEXTBYTES + 1);
  ::crypto_kdf_derive_from_key(raw(keys.to_server.data()), keys.to_server.size(), 1, kContext,
                               raw(root.data()));
  ::crypto_kdf_derive_from_key(raw(keys.to_client.data()), keys.to_client.size(), 2, kContext,
                               raw(root.data()));
  ::sodium_memzero(root.data(), root.size());
  return keys;
}

ExchangeSid random_sid() {
  [[maybe_unused]] static const int ready = ::sodium_init();
  ExchangeSid sid;
  ::randombytes_buf(sid.data(), sid.size());
  return sid;
}

}  // namespace wire
