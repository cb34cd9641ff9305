// One datagram to every listener, or to the multicast group: encoded once, sent with one system
// call, on a thread of its own.
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

#include "os/thread_signal.h"
#include "server/counters.h"
#include "wire/snapshot.h"

namespace server {

class Broadcaster {
 public:
  // fd: a non-blocking UDP socket, which must outlive this. capacity: listeners at most. priority:
  // real-time, of the sending thread; 0, or where it is not permitted: an ordinary thread.
  Broadcaster(int fd, std::size_t capacity, int priority);
  ~Broadcaster();  // as close()

  // The tick's thread; nothing here waits or takes memory.
  void add(std::uint32_t client, const sockaddr_in& listener);
  void remove(std::uint32_t client);
  // A datagram will be given soon: the thread wakes up now, beside the tick that makes it.
  void expect();
  // tick_ns: when the tick began, on the monotonic clock. A datagram that finds kParcels others
  // still waiting is dropped, and counted as an error for each listener.
  void send(std::span<const std::byte> datagram, std::int64_t tick_ns);

  void wait_sent();  // until the kernel has all that was given
  void close();      // the same, and ends the thread

  std::uint64_t sent() const { return sent_.load(std::memory_order_relaxed); }
  std::uint64_t errors() const { return errors_.load(std::memory_order_relaxed); }
  std::uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }
  // Precondition: closed.
  const SendStats& stats() const { return stats_; }

 private:
  static constexpr std::uint32_t kParcels = 16;  // 16 ms of a thread that gets no time
  // To look out for an expected datagram without going to sleep: three times what a tick takes.
  static constexpr std::int64_t kLookOutNs = 150'000;
  struct Listener {
    std::uint32_t client;
    sockaddr_in address;
  };
  // With its own listeners: who comes and goes needs no word between the threads.
  struct Parcel {
    std::array<std::byte, wire::kMaxDatagram> datagram;
    std::size_t size = 0;
    std::int64_t tick_ns = 0;
    std::vector<sockaddr_in> to;
  };
  void run(int priority);
  void await(std::uint32_t done);
  void deliver(Parcel& parcel);

  int fd_;
  std::size_t capacity_;
  std::vector<Listener> listeners_;

  std::array<Parcel, kParcels> parcels_;
  std::atomic<std::uint32_t> expected_{0}, given_{0}, done_{0};
  std::atomic<bool> closing_{false};
  os::ThreadSignal work_;

  std::vector<mmsghdr> messages_;  // this and the stats: the sending thread's
  SendStats stats_;
  std::atomic<std::uint64_t> sent_{0}, errors_{0}, bytes_{0};
  std::thread thread_;
};

}  // namespace server
