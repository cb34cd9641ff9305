// Measures when bytes last arrived on a line, to about 20 us. The poller, which reads every
// millisecond, only knows that they arrived since its last read. The watch does not read the bytes:
// if its thread is late, the poller still reads them all.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "os/file_descriptor.h"

namespace cabinet {

class ArrivalWatch {
 public:
  ArrivalWatch();
  ~ArrivalWatch();
  ArrivalWatch(const ArrivalWatch&) = delete;
  ArrivalWatch& operator=(const ArrivalWatch&) = delete;

  void watch(int fd);  // until fd is closed; from any thread
  // On CLOCK_MONOTONIC [us]; 0: none arrived yet. From any thread, without blocking.
  std::int64_t last_us() const { return last_us_.load(std::memory_order_acquire); }

 private:
  void run();

  os::FileDescriptor epoll_, end_;
  std::atomic<std::int64_t> last_us_{0};
  std::thread thread_;
};

}  // namespace cabinet
