// The UDP port's receiving side: input datagrams of joined players. All else is counted and
// dropped.
#pragma once

#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <vector>

#include "remote_source.h"
#include "server/counters.h"

namespace server {

class InputPort {
 public:
  // At most so many a tick, so that a flood costs a bounded time; the rest waits in the socket.
  static constexpr int kMaxPerTick = 128;

  // fd: a non-blocking UDP socket, which must outlive this.
  InputPort(int fd, std::uint64_t session, std::size_t capacity);

  // The client's datagrams, known by their token, go to source; null: it watches, and may not.
  void add(std::uint32_t client, std::uint64_t token, RemoteSource* source);
  void remove(std::uint32_t client);

  void receive(std::int64_t now_us);
  const InputCounters& counters() const { return counters_; }

 private:
  static constexpr int kBatch = 32;
  struct Player {
    std::uint32_t client;
    std::uint64_t token;
    RemoteSource* source;
  };
  int receive_batch();
  void take(std::span<const std::byte> datagram, std::int64_t now_us);

  int fd_;
  std::uint64_t session_;
  std::vector<Player> players_;
  InputCounters counters_;
  // One byte more than the longest: what fills it was too long.
  std::array<std::array<std::byte, wire::kMaxInputDatagram + 1>, kBatch> buffers_;
  std::array<iovec, kBatch> parts_{};
  std::array<mmsghdr, kBatch> messages_{};
};

}  // namespace server
