// Opens and closes a device on a thread of its own: on a USB serial line either may take from
// milliseconds to seconds, and so may setting the line up. The thread that polls never waits.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

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

 private:
  void run();

  // handover_ is a descriptor, or one of these. The poller moves it from idle to asked and from a
  // descriptor to idle, the thread from asked to a descriptor or, in vain, to idle.
  static constexpr int kIdle = -1, kAsked = -2;
  std::function<int()> open_;
  std::atomic<int> handover_{kIdle};
  std::atomic<int> to_close_{-1};
  std::atomic<int> error_;  // of the last attempt
  std::atomic<bool> ending_{false};
  os::ThreadSignal work_;
  std::thread thread_;
};

}  // namespace cabinet
