// Detects passes of a rod's index mark under its switch, for calibration and for play.
#pragma once

#include <optional>

#include "cabinet/calibration.h"

namespace cabinet {

struct IndexPass {
  double middle;  // [rad] midpoint of the angles at which the switch went on and off
  // [rad] signed difference of the two: width of the mark, with the sign of the rotation.
  double turned;
  double seconds;  // between the two
  double step;     // [rad] max angle step of a report around then: the resolution of both angles
};

// Tracks one rod from frame to frame.
class IndexPasses {
 public:
  // at: pose of the rod at the frame. turned: the frame's increment of its angle. Returns a pass
  // when it ends. A mark that a sliding rod moves under its switch or away from it is not a pass.
  std::optional<IndexPass> add(bool under, const RodMotion& at, double turned, double seconds);
  // Discards the state: the next frame does not continue the previous ones.
  void forget();
  bool passing() const { return entered_.has_value(); }

 private:
  struct Entry {
    RodMotion at;
    double step;
  };
  bool known_ = false, under_ = false;
  double step_ = 0, since_entry_ = 0;
  std::optional<Entry> entered_;
};

}  // namespace cabinet
