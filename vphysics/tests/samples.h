// How many random samples a test takes that has many.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace vp::test {

// VP_SAMPLES_SHARE=N: an N-th of them, for the sanitizers, under which they take seconds.
inline int samples(int all) {
  const char* share = std::getenv("VP_SAMPLES_SHARE");
  return share != nullptr ? std::max(1, all / std::max(1, std::atoi(share))) : all;
}

}  // namespace vp::test
