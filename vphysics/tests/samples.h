// The number of random samples of a test.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace vp::test {

// VP_SAMPLES_SHARE=N reduces the number by the factor N, for sanitizers, which are much slower.
inline int samples(int all) {
  const char* share = std::getenv("VP_SAMPLES_SHARE");
  return share != nullptr ? std::max(1, all / std::max(1, std::atoi(share))) : all;
}

}  // namespace vp::test
