// Loops that several workers may share: each part writes its own alone, so who does it does not
// matter.
#pragma once

#include <cstddef>
#include <memory>

#include "vphysics/task_scheduler.h"

namespace vp {

inline constexpr std::size_t kBodyGrain = 256;  // bodies: some microseconds

struct Workers {
  std::shared_ptr<TaskScheduler> scheduler;  // none: all is done by who calls step()

  // f(begin, end) of parts of [0, count).
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
