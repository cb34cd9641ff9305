#include "vphysics/tbb_task_scheduler.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace vp {
namespace {

class TbbTaskScheduler final : public TaskScheduler {
 public:
  explicit TbbTaskScheduler(int workers)
      : arena_(workers > 0 ? workers : oneapi::tbb::task_arena::automatic) {}

  void run(std::size_t count, std::size_t grain, const Task& task) override {
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    const std::size_t parts = (count + grain - 1) / grain;
    arena_.execute([&] {
      oneapi::tbb::parallel_for(Range(0, parts), [&](const Range& r) {
        task(r.begin() * grain, std::min(count, r.end() * grain));
      });
    });
  }

 private:
  oneapi::tbb::task_arena arena_;
};

}  // namespace

std::shared_ptr<TaskScheduler> make_tbb_task_scheduler(int workers) {
  return std::make_shared<TbbTaskScheduler>(workers);
}

}  // namespace vp
