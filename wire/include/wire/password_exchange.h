// A key from a password that both sides know, over a line that anyone may read and change: CPace,
// CPACE-RISTR255-SHA512 in its initiator-responder form (draft-irtf-cfrg-cpace, the balanced PAKE
// chosen by the CFRG), by libsodium's ristretto255.
//
//   g   = map_to_group(SHA-512(lv(DSI) lv(password) lv(zeros) lv(CI) lv(sid)))
//   Ya  = ya g, Yb = yb g                 what the two sides send
//   K   = ya Yb = yb Ya
//   ISK = SHA-512(lv("..._ISK") lv(sid) lv(K) lv(Ya) lv(ADa) lv(Yb) lv(ADb))
//
// Who listens, or answers in the server's place, learns nothing to try passwords against: each
// guess costs a connection. The password never leaves the machine. Keys of the past stay secret
// when the password becomes known.
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
using ExchangeSid = std::array<std::byte, kSidBytes>;      // the client's: random, once
using ExchangeShare = std::array<std::byte, kShareBytes>;  // Ya, Yb
using ExchangeSecret = std::array<std::byte, 64>;          // ISK

// The sealed stream's keys.
struct StreamKeys {
  SealKey to_server, to_client;
};

class PasswordExchange {
 public:
  enum class Side : std::uint8_t { client, server };

  // channel: what the key is for (CI); another one gives another key.
  PasswordExchange(Side side, const std::string& password, const std::string& channel,
                   const ExchangeSid& sid);
  // With this scalar in place of a random one: for test vectors.
  PasswordExchange(Side side, const std::string& password, const std::string& channel,
                   const ExchangeSid& sid, const std::array<std::byte, 32>& scalar);
  ~PasswordExchange();
  PasswordExchange(const PasswordExchange&) = delete;
  PasswordExchange& operator=(const PasswordExchange&) = delete;

  const ExchangeShare& share() const { return share_; }
  // Nothing for a share that is no group element or the neutral one.
  std::optional<ExchangeSecret> secret(const ExchangeShare& others,
                                       const std::string& client_data = {},
                                       const std::string& server_data = {}) const;

 private:
  Side side_;
  ExchangeSid sid_;
  std::array<std::byte, 32> scalar_{};
  ExchangeShare share_{};
};

// What the key is for, by the role asked for: a guest's password makes nobody host.
const char* exchange_channel(bool host);

StreamKeys stream_keys(const ExchangeSecret& secret);
ExchangeSid random_sid();

}  // namespace wire
