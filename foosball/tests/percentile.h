// The value below which a share of the values lies.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace foosball {

inline double percentile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace foosball
