// Durations of the last steps.
#pragma once

#include <cstddef>
#include <vector>

namespace sandbox {

class StepTimes {
 public:
  struct Statistics {
    double median = 0.0, p99 = 0.0, max = 0.0;  // of the stored steps [us]
  };

  // kept: number of stored steps, >= 1.
  explicit StepTimes(std::size_t kept) : kept_(kept) {}

  void add(double us);
  void clear();
  std::size_t size() const { return ring_.size(); }  // number of stored steps
  // Of the last `count` steps. All 0 before the first step. The quantile q of n steps is the
  // smallest of them that at least q n of them do not exceed.
  Statistics statistics(std::size_t count) const;
  Statistics statistics() const { return statistics(kept_); }
  // The last steps, the newest at the end; fewer if fewer are stored.
  std::vector<double> last(std::size_t count) const;

 private:
  std::size_t kept_, next_ = 0;
  std::vector<double> ring_;
};

}  // namespace sandbox
