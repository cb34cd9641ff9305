// Derives a key from a shared password over a line that anyone may read and change: CPace,
// CPACE-RISTR255-SHA512 in its initiator-responder form (draft-irtf-cfrg-cpace, the balanced PAKE
// chosen by the CFRG), with libsodium's ristretto255.
//
//   g   = map_to_group(SHA-512(lv(DSI) lv(password) lv(zeros) lv(CI) lv(sid)))
//   Ya  = ya g, Yb = yb g                 the two messages
//   K   = ya Yb = yb Ya
//   ISK = SHA-512(lv("..._ISK") lv(sid) lv(K) lv(Ya) lv(ADa) lv(Yb) lv(ADb))
//
// An eavesdropper, or an impostor in the server's place, learns nothing that allows an offline
// dictionary attack: each guess costs a connection. The password is never sent. Forward secrecy:
// past keys stay secret if the password becomes known.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "wire/seal.h"

namespace wire {

inline constexpr std::size_t kSidBytes = 16;
inline constexpr std::size_t kShareBytes = 32;
using ExchangeSid = std::array<std::byte, kSidBytes>;  // chosen by the client: random, used once
using ExchangeShare = std::array<std::byte, kShareBytes>;  // Ya, Yb
using ExchangeSecret = std::array<std::byte, 64>;          // ISK

// Keys of the sealed stream.
struct StreamKeys {
  SealKey to_server, to_client;
};

class PasswordExchange {
 public:
  enum class Side : std::uint8_t { client, server };

  // channel: the purpose of the key (CI); another channel gives another key.
  PasswordExchange(Side side, const std::string& password, const std::string& channel,
                   const ExchangeSid& sid);
  // Uses this scalar instead of a random one: for test vectors.
  PasswordExchange(Side side, const std::string& password, const std::string& channel,
                   const ExchangeSid& sid, const std::array<std::byte, 32>& scalar);
  ~PasswordExchange();
  PasswordExchange(const PasswordExchange&) = delete;
  PasswordExchange& operator=(const PasswordExchange&) = delete;

  const ExchangeShare& share() const { return share_; }
  // Returns nothing if the share is not a group element or is the neutral element.
  std::optional<ExchangeSecret> secret(const ExchangeShare& others,
                                       const std::string& client_data = {},
                                       const std::string& server_data = {}) const;

 private:
  Side side_;
  ExchangeSid sid_;
  std::array<std::byte, 32> scalar_{};
  ExchangeShare share_{};
};

// The channel (CI) of the requested role, so that a guest's password does not grant the host role.
const char* exchange_channel(bool host);

StreamKeys stream_keys(const ExchangeSecret& secret);
ExchangeSid random_sid();

}  // namespace wire
