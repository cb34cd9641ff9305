// Who does a world's work in parallel: the user's job system, or oneTBB (tbb_task_scheduler.h). The
// results do not depend on who does it, nor on how many: the same bits with none, one or more
// workers.
#pragma once

#include <cstddef>
#include <memory>

namespace vp {

class TaskScheduler {
 public:
  virtual ~TaskScheduler() = default;

  // What to do for parts [begin, end) of a range.
  struct Task {
    void (*call)(void* data, std::size_t begin, std::size_t end);
    void* data;

    void operator()(std::size_t begin, std::size_t end) const { call(data, begin, end); }
  };
  // Calls the task for parts that together are [0, count), each once and in any order, on any
  // threads, the caller's among them; every part begins at a multiple of grain and is no longer
  // than that, but for several multiples in a row if that suits. Returns when all are done, and
  // what they have written is seen by the caller. Must not throw.
  virtual void run(std::size_t count, std::size_t grain, const Task& task) = 0;
};

}  // namespace vp
