#include "vphysics/stages.h"

#include <cstddef>
#include <iterator>

namespace vp {

const char* name_of(Stage stage) {
  constexpr const char* kNames[] = {"prepare",   "broad phase", "narrow phase", "contact slots",
                                    "sub-steps", "report",      "forces",       "impacts",
                                    "advance",   "sleep"};
  const auto index = static_cast<std::size_t>(stage);
  return index < std::size(kNames) ? kNames[index] : "";
}

void StageClock::begin(Stage) {
  begun_ = now_();
}

void StageClock::end(Stage stage) {
  total_[static_cast<std::size_t>(stage)] += now_() - begun_;
}

}  // namespace vp
