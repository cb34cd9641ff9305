// Corrects a rod's angle in play by its index mark. Counts drift, the mark does not. Each pass that
// was slow enough measures the error of the angle, which is then removed too slowly to be visible.
// The first pass determines where the feet are: until then the angle is relative to the initial
// one.
#pragma once

#include <cstdint>
#include <optional>

#include "index_pass.h"

namespace cabinet {

class IndexReference {
 public:
  explicit IndexReference(const RodCalibration& calibration);

  // at: pose of the rod at the frame. turned: the frame's increment of its angle. Returns the
  // correction to add to the angle.
  double frame(bool under, const RodMotion& at, double turned, double seconds);
  // The rod may have been turned without being counted.
  void lose();

  bool known() const { return known_; }  // the angle is from feet straight down
  // Passes that contradicted the angle by more than a quarter turn. They change nothing: the mark
  // or its switch has moved.
  std::uint64_t disagreements() const { return disagreements_; }

 private:
  void take(const IndexPass& pass);

  std::optional<IndexMark> mark_;
  double max_step_;
  IndexPasses passes_;
  bool known_ = false;
  double left_ = 0;  // [rad] remaining correction
  double rate_ = 0;  // [rad/s] of the correction
  std::uint64_t disagreements_ = 0;
};

}  // namespace cabinet
