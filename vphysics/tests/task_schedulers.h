// Task schedulers for the tests.
#pragma once

#include <algorithm>
#include <cstddef>

#include "vphysics/task_scheduler.h"

namespace vp::test {

// Runs the grains one after the other, in reverse order.
class Backwards final : public TaskScheduler {
 public:
  int parts = 0;

  void run(std::size_t count, std::size_t grain, const Task& task) override {
    for (std::size_t i = (count + grain - 1) / grain; i-- > 0;) {
      task(i * grain, std::min(count, (i + 1) * grain));
      ++parts;
    }
  }
};

}  // namespace vp::test
