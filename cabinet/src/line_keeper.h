// Opens and closes a device on a thread of its own: on a USB serial line either may take from
// milliseconds to seconds, and so may setting the line up. It also writes to those whose write(2)
// waits for the device. The thread that polls never waits.
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
  // open: returns a descriptor that is ready to be read, or -1 and errno. It may wait.
  explicit LineKeeper(std::function<int()> open);
  ~LineKeeper();  // waits for the thread, closes what nobody took
  LineKeeper(const LineKeeper&) = delete;
  LineKeeper& operator=(const LineKeeper&) = delete;

  // Both on one thread, without waiting or taking memory.
  // The descriptor; or -1, one is asked for, to be taken later, and errno says why the last attempt
  // failed (ENOENT while there was none).
  int take();
  void close(int fd);  // closed before the next is opened
  // Writes a packet to a descriptor that was taken and not closed. False: as many wait already as
  // there is room for, or it is longer than kMostPacket.
  bool send(int fd, std::span<const std::byte> packet);

 private:
  void run();
  void write_packets();

  struct Packet {
    int fd = -1;
    std::size_t size = 0;
    std::array<std::byte, kMostPacket> bytes{};
  };

  // handover_ is a descriptor, or one of these. The poller moves it from idle to asked and from a
  // descriptor to idle, the thread from asked to a descriptor or, in vain, to idle.
  static constexpr int kIdle = -1, kAsked = -2;
  std::function<int()> open_;
  std::atomic<int> handover_{kIdle};
  std::atomic<int> to_close_{-1};
  std::atomic<int> error_;  // of the last attempt
  std::atomic<bool> ending_{false};
  // Written by the poller up to put_, by the thread taken out up to taken_: counters, of the places
  // modulo their number.
  std::array<Packet, 16> packets_{};
  std::atomic<std::uint32_t> put_{0}, taken_{0};
  os::ThreadSignal work_;
  std::thread thread_;
};

}  // namespace cabinet
