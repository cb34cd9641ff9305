// The receiving side of the UDP port: input datagrams of joined players. All other datagrams are
// counted and dropped.
//
// Each player has its own socket, which only receives from the player's address and port, and its
// own quota per tick: a flood cannot displace another player's inputs. Datagrams from elsewhere
// arrive at the shared socket; a few of them are read per tick, to count them.
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
  // Max datagrams per tick, of each player and of unknown senders, so that a flood costs a bounded
  // time. The rest waits in the socket. A player sends one per tick: this catches up after a stall
  // of 64 ms.
  static constexpr int kMaxPerTick = 64;
  static constexpr int kMaxStrayPerTick = 32;

  // fd: the port's non-blocking UDP socket, which must outlive this. capacity: max number of
  // players.
  InputPort(int fd, std::uint64_t session, std::size_t capacity);

  struct Key {
    std::uint32_t client = 0;
    std::uint64_t token = 0;
    wire::SealKey seal{};
  };
  // Reads the client's datagrams from this socket into source. Replaces an existing entry.
  void add(const Key& key, os::FileDescriptor socket, RemoteSource& source);
  // Sends its datagrams to this source from now on; null: discards them. Keeps the replay window,
  // so that old datagrams are still rejected. False: the client was never added.
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
  // One byte more than the longest valid datagram: a full buffer means it was too long.
  std::array<std::array<std::byte, kMaxSealed + 1>, kBatch> buffers_;
  std::array<iovec, kBatch> parts_{};
  std::array<mmsghdr, kBatch> messages_{};
};

}  // namespace server
