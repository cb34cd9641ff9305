// Wakes a thread that waits, as often as it was posted. post() never waits and takes no memory: a
// real-time thread may call it.
#pragma once

#include <semaphore.h>

namespace os {

class ThreadSignal {
 public:
  ThreadSignal() { ::sem_init(&semaphore_, 0, 0); }
  ~ThreadSignal() { ::sem_destroy(&semaphore_); }
  ThreadSignal(const ThreadSignal&) = delete;
  ThreadSignal& operator=(const ThreadSignal&) = delete;

  void post() { ::sem_post(&semaphore_); }
  // May return early: when a signal comes. Look whether there is anything to do.
  void wait() { ::sem_wait(&semaphore_); }

 private:
  sem_t semaphore_;
};

}  // namespace os
