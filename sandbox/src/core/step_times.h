// How long the last steps took.
#pragma once

#include <cstddef>
#include <vector>

namespace sandbox {

class StepTimes {
 public:
  struct Figures {
    double median = 0.0, p99 = 0.0, max = 0.0;  // of the kept [us]
  };

  // kept: so many of the last steps are in the figures, >= 1.
  explicit StepTimes(std::size_t kept) : kept_(kept) {}

  void add(double us);
  void clear();
  std::size_t size() const { return ring_.size(); }  // of the kept
  // Of so many of the last. All 0 before the first step. A share q of n steps is the least of them
  // that q n are at most.
  Figures figures(std::size_t count) const;
  Figures figures() const { return figures(kept_); }
  // The last ones, the newest at the end; fewer if there were fewer.
  std::vector<double> last(std::size_t count) const;

 private:
  std::size_t kept_, next_ = 0;
  std::vector<double> ring_;
};

}  // namespace sandbox
