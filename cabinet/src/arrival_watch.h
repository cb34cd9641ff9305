// Says when bytes last came on a line, to some 20 us: the poller, which looks each millisecond,
// only knows that they came since it looked before. The bytes themselves it leaves to the poller:
// if this thread is late, the poller reads them all the same.
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

  void watch(int fd);  // until it is closed; any thread
  // Of CLOCK_MONOTONIC [us]; 0: none came yet. Any thread, without waiting.
  std::int64_t last_us() const { return last_us_.load(std::memory_order_acquire); }

 private:
  void run();

  os::FileDescriptor epoll_, end_;
  std::atomic<std::int64_t> last_us_{0};
  std::thread thread_;
};

}  // namespace cabinet
