#include "vphysics/stages.h"

namespace vp {

const char* name_of(Stage stage) {
  switch (stage) {
    case Stage::prepare:
      return "prepare";
    case Stage::broad_phase:
      return "broad phase";
    case Stage::narrow_phase:
      return "narrow phase";
    case Stage::lanes:
      return "lanes";
    case Stage::sub_steps:
      return "sub-steps";
    case Stage::report:
      return "report";
    case Stage::forces:
      return "forces";
    case Stage::impacts:
      return "impacts";
    case Stage::advance:
      return "advance";
    case Stage::sleep:
      return "sleep";
  }
  return "";
}

void StageClock::begin(Stage) {
  begun_ = now_();
}

void StageClock::end(Stage stage) {
  total_[static_cast<std::size_t>(stage)] += now_() - begun_;
}

}  // namespace vp
