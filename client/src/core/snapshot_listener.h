// The UDP thread: receives snapshots, and sends the person's input.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <thread>

#include "client/snapshot_buffer.h"
#include "core/sockets.h"
#include "wire/control.h"
#include "wire/input_datagram.h"
#include "wire/seal.h"

namespace client {

class SnapshotListener {
 public:
  explicit SnapshotListener(UdpSocket unicast);
  ~SnapshotListener();

  std::uint16_t port() const { return unicast_.port; }
  bool small_buffer() const { return unicast_.small_buffer; }

  // From now on accepts snapshots of this session, sealed as the Welcome says, that come from that
  // server's address and port. Inputs are sent there, beginning with the next call of drive().
  // here: the address by which this machine reaches the server. The error is a sentence (the
  // multicast group cannot be joined).
  tl::expected<void, std::string> join(const wire::Welcome& welcome,
                                       const os::SocketAddress& server,
                                       const os::SocketAddress& here);
  // No longer joined: nothing is sent.
  void leave();

  SceneSample sample(std::int64_t now_us);
  std::vector<wire::EventSnapshot> take_events();
  SnapshotCounters counters() const;
  std::int64_t delay_us() const;
  std::int64_t last_arrival_us() const { return last_arrival_us_.load(std::memory_order_relaxed); }

  void drive(std::uint64_t session, const std::array<wire::InputRod, 8>& rods, std::int64_t now_us);
  std::uint64_t inputs_sent() const { return inputs_sent_.load(std::memory_order_relaxed); }

 private:
  void run();
  void receive(int socket);
  void take(std::span<const std::byte> sealed, std::int64_t arrival);
  int send_due(std::int64_t now_us);
  void send_input(std::int64_t now_us);

  UdpSocket unicast_;
  Waker waker_;
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> last_arrival_us_{0};
  std::atomic<std::uint64_t> inputs_sent_{0};

  mutable std::mutex mutex_;  // guards all below
  SnapshotBuffer buffer_;
  wire::Snapshot received_;
  std::shared_ptr<const UdpSocket> multicast_;
  bool joined_ = false;
  wire::DatagramOpener opener_;
  wire::SealKey input_key_{};
  std::uint32_t client_ = 0;
  std::uint64_t sealed_ = 0;  // inputs sealed with this key
  wire::InputDatagram input_;
  bool input_changed_ = false, input_known_ = false;
  std::int64_t driven_at_us_ = 0, sent_at_us_ = 0;

  std::thread thread_;  // last: starts after all else is constructed
};

}  // namespace client
