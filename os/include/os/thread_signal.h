// Wakes a waiting thread once per post(). post() never blocks and never allocates: a real-time
// thread may call it.
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
  // May return early, when a signal arrives. The caller must check whether there is work.
  void wait() { ::sem_wait(&semaphore_); }

 private:
  sem_t semaphore_;
};

}  // namespace os
