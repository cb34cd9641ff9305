// Fixed-size histogram of durations, log-linear like HdrHistogram: 32 buckets per octave, from 1 ns
// to 2^40 ns (18 minutes). A quantile is at most 1/32 (3.2%) above the true value. No allocation.
// Single-threaded: the same thread writes and reads.
#pragma once

#include <array>
#include <cstdint>

namespace server {

class Histogram {
 public:
  void record(std::int64_t value_ns);  // negative: counts as 0; beyond the range: last bucket

  // Upper end of the first bucket at which the cumulative fraction of values reaches q; never above
  // max(). 0 when empty. Precondition: 0 <= q <= 1.
  std::int64_t quantile(double q) const;
  std::int64_t max() const { return max_; }
  std::uint64_t count() const { return count_; }
  double mean() const {
    return count_ == 0 ? 0.0 : static_cast<double>(sum_) / static_cast<double>(count_);
  }

 private:
  static constexpr int kStepBits = 5;  // 2^5 buckets per octave
  static constexpr int kValueBits = 40;
  static constexpr int kBuckets = ((kValueBits - kStepBits) + 1) << kStepBits;

  static int bucket_of(std::uint64_t value);
  static std::int64_t upper_end(int bucket);

  std::array<std::uint64_t, kBuckets> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t sum_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace server
