// Loops that several workers may share. Each part writes only its own data, so the results do not
// depend on the worker.
#pragma once

#include <cstddef>
#include <memory>

#include "vphysics/task_scheduler.h"

namespace vp {

inline constexpr std::size_t kBodyGrain = 256;  // bodies: some microseconds

struct Workers {
  std::shared_ptr<TaskScheduler> scheduler;  // null: the thread that calls step() does all the work

  // Calls f(begin, end) for parts of [0, count).
  template <class F>
  void in_parallel(std::size_t count, std::size_t grain, const F& f) const {
    if (!scheduler || count < 2 * grain) {
      if (count > 0) f(std::size_t{0}, count);
      return;
    }
    scheduler->run(count, grain,
                   {[](void* data, std::size_t begin, std::size_t end) {
                      (*static_cast<const F*>(data))(begin, end);
                    },
                    const_cast<F*>(&f)});
  }
};

}  // namespace vp
