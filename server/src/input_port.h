// The UDP port's receiving side: input datagrams of joined players. All else is counted and
// dropped.
//
// Each player has a socket of its own, which the kernel fills with what comes from its address and
// port alone, and a share of the tick of its own: no flood takes another player's inputs away. What
// comes from elsewhere stays in the shared socket, of which a few are looked at, for the count.
#pragma once

#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <vector>

#include "os/file_descriptor.h"
#include "remote_source.h"
#include "server/counters.h"
#include "wire/seal.h"

namespace server {

class InputPort {
 public:
  // At most so many a tick, of each player and of strangers, so that a flood costs a bounded time;
  // the rest waits in its socket. A player sends one a tick: this makes up a stall of 64 ms at
  // once.
  static constexpr int kMaxPerTick = 64;
  static constexpr int kMaxStrayPerTick = 32;

  // fd: the port's non-blocking UDP socket, which must outlive this. capacity: players at most.
  InputPort(int fd, std::uint64_t session, std::size_t capacity);

  struct Key {
    std::uint32_t client = 0;
    std::uint64_t token = 0;
    wire::SealKey seal{};
  };
  // The client's datagrams come by this socket, and go to source. Replaces what it had.
  void add(const Key& key, os::FileDescriptor socket, RemoteSource& source);
  // Its datagrams go to this source from now on, none: nowhere; what was heard of it counts on, so
  // that nothing old is taken for new. False: it was never added.
  bool redirect(std::uint32_t client, RemoteSource* source);
  void remove(std::uint32_t client);

  void receive(std::int64_t now_us);
  const InputCounters& counters() const { return counters_; }

 private:
  static constexpr int kBatch = 32;
  static constexpr std::size_t kMaxSealed = wire::kMaxInputDatagram + wire::kSealBytes;
  struct Player {
    Key key;
    os::FileDescriptor socket;
    RemoteSource* source;  // null: has no rods now
    wire::DatagramOpener opener;
  };
  std::span<const std::byte> datagram(int i) const {
    return {buffers_[i].data(), messages_[i].msg_len};
  }
  int receive_batch(int fd);
  void receive_of(Player& player, std::int64_t now_us);
  void take(Player& player, std::span<const std::byte> sealed, std::int64_t now_us);

  int fd_;
  std::uint64_t session_;
  std::vector<Player> players_;
  InputCounters counters_;
  // One byte more than the longest: what fills it was too long.
  std::array<std::array<std::byte, kMaxSealed + 1>, kBatch> buffers_;
  std::array<iovec, kBatch> parts_{};
  std::array<mmsghdr, kBatch> messages_{};
};

}  // namespace server
