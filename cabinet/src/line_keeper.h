// Opens, configures and closes a device on a thread of its own: each may take milliseconds to
// seconds on a USB serial line. It also writes to devices whose write(2) blocks. The polling thread
// never blocks.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <thread>

#include "cabinet/device.h"
#include "os/thread_signal.h"

namespace cabinet {

class LineKeeper {
 public:
  // open: returns a descriptor that is ready to read, or -1 and errno. It may block.
  explicit LineKeeper(std::function<int()> open);
  ~LineKeeper();  // joins the thread and closes a descriptor that was not taken
  LineKeeper(const LineKeeper&) = delete;
  LineKeeper& operator=(const LineKeeper&) = delete;

  // take() and close() run on one thread, without blocking or allocating memory.
  //
  // take() returns the descriptor; or -1 after requesting one for a later call. errno then holds
  // the error of the last attempt (ENOENT before the first).
  int take();
  void close(int fd);  // closes fd before the next open
  // Queues a packet for a descriptor that was taken and not closed. False: the queue is full, or
  // the packet is longer than kMaxPacket.
  bool send(int fd, std::span<const std::byte> packet);

 private:
  void run();
  void write_packets();

  struct Packet {
    int fd = -1;
    std::size_t size = 0;
    std::array<std::byte, kMaxPacket> bytes{};
  };

  // handover_ is a descriptor or one of these states. The poller changes it from idle to asked, and
  // from a descriptor to idle. The thread changes it from asked to a descriptor, or to idle on
  // failure.
  static constexpr int kIdle = -1, kAsked = -2;
  std::function<int()> open_;
  std::atomic<int> handover_{kIdle};
  std::atomic<int> to_close_{-1};
  std::atomic<int> error_;  // of the last attempt
  std::atomic<bool> ending_{false};
  // Ring buffer. The poller writes entries up to put_, the thread reads up to taken_. Both are
  // counters; their index is modulo the capacity.
  std::array<Packet, 16> packets_{};
  std::atomic<std::uint32_t> put_{0}, taken_{0};
  os::ThreadSignal work_;
  std::thread thread_;
};

}  // namespace cabinet
