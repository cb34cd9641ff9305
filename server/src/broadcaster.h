// Sends one datagram to every listener, or to the multicast group: encoded once, sealed for each
// listener, sent with one system call on its own thread.
//
// On loopback the kernel delivers during the sender's call and wakes each receiver: 20 us for one
// listener, 65 us for thirty. The tick only queues the datagram and wakes this thread, which takes
// 4 us for any number of listeners. See docs/decisions/0011.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "os/socket_address.h"
#include "os/thread_signal.h"
#include "server/counters.h"
#include "wire/seal.h"
#include "wire/snapshot.h"

namespace server {

class Broadcaster {
 public:
  // fd: a non-blocking UDP socket, which must outlive this. capacity: max number of listeners.
  // priority: real-time priority of the sender thread; 0, or if not permitted: an ordinary thread.
  Broadcaster(int fd, std::size_t capacity, int priority);
  ~Broadcaster();  // as close()

  // Tick thread; these calls never block and never allocate.
  struct Listener {
    std::uint32_t client = 0;  // and the id of its key; 0: a multicast group
    os::SocketAddress to;
    os::SocketAddress from;  // local address to send from; none: the kernel chooses
    wire::SealKey key{};
  };
  void add(const Listener& listener);
  void remove(std::uint32_t client);
  // A datagram will follow soon: wakes the thread now, in parallel with the tick that makes it.
  void expect();
  // counter: increases from call to call, and is never reused; see wire/seal.h. tick_ns: when the
  // tick began, on the monotonic clock. If kParcels datagrams are pending, this one is dropped and
  // counted as an error for each listener.
  void send(std::span<const std::byte> datagram, std::uint64_t counter, std::int64_t tick_ns);

  void wait_sent();  // until the kernel has every datagram
  void close();      // waits like wait_sent(), then ends the thread

  std::uint64_t sent() const { return sent_.load(std::memory_order_relaxed); }
  std::uint64_t errors() const { return errors_.load(std::memory_order_relaxed); }
  int last_error() const { return last_error_.load(std::memory_order_relaxed); }  // errno
  std::uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }
  // Precondition: closed.
  const SendStats& stats() const { return stats_; }

 private:
  static constexpr std::uint32_t kParcels = 16;  // 16 ms without processor time
  // Busy-wait for an expected datagram before sleeping: three times the duration of a tick.
  static constexpr std::int64_t kLookOutNs = 150'000;
  // Each parcel has its own list of listeners, so that changes need no other synchronisation.
  struct Parcel {
    std::array<std::byte, wire::kMaxDatagram> datagram;
    std::size_t size = 0;
    std::uint64_t counter = 0;
    std::int64_t tick_ns = 0;
    std::vector<Listener> to;
  };
  // The kernel's input for one listener.
  struct Sealed {
    std::array<std::byte, wire::kMaxDatagram + wire::kSealBytes> bytes;
    alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(in6_pktinfo))> control;
    iovec part;
  };
  void run(int priority);
  void await(std::uint32_t done);
  bool spare_core();
  void prepare(Parcel& parcel, std::size_t i);
  void deliver(Parcel& parcel);

  int fd_;
  std::size_t capacity_;
  std::vector<Listener> listeners_;

  std::array<Parcel, kParcels> parcels_;
  std::atomic<std::uint32_t> expected_{0}, given_{0}, done_{0};
  std::atomic<bool> closing_{false};
  os::ThreadSignal work_;

  // These and the stats belong to the sender thread.
  std::vector<mmsghdr> messages_;
  std::vector<Sealed> sealed_;
  std::uint32_t looked_at_cores_ = 0;
  bool spare_core_ = false;
  int failed_waits_ = 0;  // consecutive busy-waits without a datagram in time
  SendStats stats_;
  std::atomic<std::uint64_t> sent_{0}, errors_{0}, bytes_{0};
  std::atomic<int> last_error_{0};
  std::thread thread_;
};

}  // namespace server
