#include "server/histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace server {

// Values below 2^kStepBits have one bucket each. Above, the octave and the kStepBits bits after the
// leading bit select the bucket.
int Histogram::bucket_of(std::uint64_t value) {
  if (value < (1u << kStepBits)) return static_cast<int>(value);
  const int shift = static_cast<int>(std::bit_width(value)) - 1 - kStepBits;
  return (shift << kStepBits) + static_cast<int>(value >> shift);
}

std::int64_t Histogram::upper_end(int bucket) {
  if (bucket < (1 << kStepBits)) return bucket;
  const int shift = (bucket >> kStepBits) - 1;
  const std::int64_t lead = (bucket & ((1 << kStepBits) - 1)) + (1 << kStepBits);
  return ((lead + 1) << shift) - 1;
}

void Histogram::record(std::int64_t value_ns) {
  constexpr std::int64_t kTop = (std::int64_t{1} << kValueBits) - 1;
  const std::int64_t value = std::clamp<std::int64_t>(value_ns, 0, kTop);
  ++counts_[static_cast<std::size_t>(bucket_of(static_cast<std::uint64_t>(value)))];
  ++count_;
  sum_ += value;
  max_ = std::max(max_, value);
}

std::int64_t Histogram::quantile(double q) const {
  if (count_ == 0) return 0;
  const auto wanted = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_))));
  std::uint64_t seen = 0;
  for (int bucket = 0; bucket < kBuckets; ++bucket) {
    seen += counts_[static_cast<std::size_t>(bucket)];
    if (seen >= wanted) return std::min(upper_end(bucket), max_);
  }
  return max_;
}

}  // namespace server
