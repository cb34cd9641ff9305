// Runs a world's work in parallel: the user's job system, or oneTBB (tbb_task_scheduler.h). The
// results are the same bits with no scheduler and with any number of workers.
#pragma once

#include <cstddef>
#include <memory>

namespace vp {

class TaskScheduler {
 public:
  virtual ~TaskScheduler() = default;

  // The work for [begin, end) of a range.
  struct Task {
    void (*call)(void* data, std::size_t begin, std::size_t end);
    void* data;

    void operator()(std::size_t begin, std::size_t end) const { call(data, begin, end); }
  };
  // Calls the task for parts that together cover [0, count), each index exactly once. The parts may
  // run in any order, on any threads, the caller's included. Every part begins at a multiple of
  // grain. Its length is grain, or a multiple of it (the last part may be shorter). Returns when
  // all parts are done; their writes are visible to the caller. Must not throw.
  virtual void run(std::size_t count, std::size_t grain, const Task& task) = 0;
};

}  // namespace vp
