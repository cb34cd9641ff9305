// One datagram to every listener, or to the multicast group: encoded once, sealed for each, sent
// with one system call, on a thread of its own.
//
// On loopback the kernel delivers within the sender's call and wakes each receiver: 20 us for one
// listener, 65 us for thirty. The tick only puts the datagram down and wakes this thread, 4 us
// however many listen. See docs/decisions/0011.
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
  // fd: a non-blocking UDP socket, which must outlive this. capacity: listeners at most. priority:
  // real-time, of the sending thread; 0, or where it is not permitted: an ordinary thread.
  Broadcaster(int fd, std::size_t capacity, int priority);
  ~Broadcaster();  // as close()

  // The tick's thread; nothing here waits or takes memory.
  struct Listener {
    std::uint32_t client = 0;  // and the id of its key; 0: a multicast group
    os::SocketAddress to;
    os::SocketAddress from;  // of this machine's addresses; none: the kernel chooses
    wire::SealKey key{};
  };
  void add(const Listener& listener);
  void remove(std::uint32_t client);
  // A datagram will be given soon: the thread wakes up now, beside the tick that makes it.
  void expect();
  // counter: rises from call to call, and is never used twice; see wire/seal.h.
  // tick_ns: when the tick began, on the monotonic clock. A datagram that finds kParcels others
  // still waiting is dropped, and counted as an error for each listener.
  void send(std::span<const std::byte> datagram, std::uint64_t counter, std::int64_t tick_ns);

  void wait_sent();  // until the kernel has all that was given
  void close();      // the same, and ends the thread

  std::uint64_t sent() const { return sent_.load(std::memory_order_relaxed); }
  std::uint64_t errors() const { return errors_.load(std::memory_order_relaxed); }
  int last_error() const { return last_error_.load(std::memory_order_relaxed); }  // errno
  std::uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }
  // Precondition: closed.
  const SendStats& stats() const { return stats_; }

 private:
  static constexpr std::uint32_t kParcels = 16;  // 16 ms of a thread that gets no time
  // To look out for an expected datagram without going to sleep: three times what a tick takes.
  static constexpr std::int64_t kLookOutNs = 150'000;
  // With its own listeners: who comes and goes needs no word between the threads.
  struct Parcel {
    std::array<std::byte, wire::kMaxDatagram> datagram;
    std::size_t size = 0;
    std::uint64_t counter = 0;
    std::int64_t tick_ns = 0;
    std::vector<Listener> to;
  };
  // What the kernel is given for one listener.
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

  // These and the stats: the sending thread's.
  std::vector<mmsghdr> messages_;
  std::vector<Sealed> sealed_;
  std::uint32_t looked_at_cores_ = 0;
  bool spare_core_ = false;
  int vain_ = 0;  // waits in a row, awake, for a datagram that did not come in time
  SendStats stats_;
  std::atomic<std::uint64_t> sent_{0}, errors_{0}, bytes_{0};
  std::atomic<int> last_error_{0};
  std::thread thread_;
};

}  // namespace server
