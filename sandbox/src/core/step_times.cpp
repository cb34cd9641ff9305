#include "core/step_times.h"

#include <algorithm>
#include <cmath>

namespace sandbox {
namespace {

double share(std::vector<double>& steps, double q) {
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(steps.size())));
  const auto at = steps.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(steps.begin(), at, steps.end());
  return *at;
}

}  // namespace

void StepTimes::add(double us) {
  if (ring_.size() < kept_) {
    ring_.push_back(us);
  } else {
    ring_[next_] = us;
    next_ = (next_ + 1) % kept_;
  }
}

void StepTimes::clear() {
  ring_.clear();
  next_ = 0;
}

StepTimes::Statistics StepTimes::statistics(std::size_t count) const {
  std::vector<double> steps = last(count);
  if (steps.empty()) return {};
  return {share(steps, 0.5), share(steps, 0.99), *std::max_element(steps.begin(), steps.end())};
}

std::vector<double> StepTimes::last(std::size_t count) const {
  count = std::min(count, ring_.size());
  std::vector<double> out;
  out.reserve(count);
  for (std::size_t i = ring_.size() - count; i < ring_.size(); ++i) {
    out.push_back(ring_[(next_ + i) % ring_.size()]);
  }
  return out;
}

}  // namespace sandbox
