// A rod's index mark as it passes under its switch: what both a calibration and play see of it.
#pragma once

#include <optional>

#include "cabinet/calibration.h"

namespace cabinet {

struct IndexPass {
  double middle;  // [rad] between the angles at which the switch went on and off
  double turned;  // [rad] between the two, signed: the mark's width and the way that the rod turned
  double seconds;  // between the two
  double step;  // [rad] the most that one report of about then had: so well known are both angles
};

// Follows one rod from frame to frame.
class IndexPasses {
 public:
  // at: where the rod is by the frame; turned: what the frame added to its angle. A pass, when it
  // is over: a mark that a sliding rod brings under its switch, or takes away, has passed nothing.
  std::optional<IndexPass> add(bool under, const RodMotion& at, double turned, double seconds);
  // What was before the next frame does not belong to it.
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
