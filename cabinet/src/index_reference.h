// What keeps a rod's angle true in play: its index mark. Counts drift, the mark stays; each pass
// that was slow enough says by how much the angle is off, and that is taken out too slowly to be
// seen. The first pass says where the feet are: until then the angle is from wherever the rod was.
#pragma once

#include <cstdint>
#include <optional>

#include "index_pass.h"

namespace cabinet {

class IndexReference {
 public:
  explicit IndexReference(const RodCalibration& calibration);

  // at: where the rod is by the frame; turned: what the frame added to its angle. Returns what is
  // to be added to the angle besides.
  double frame(bool under, const RodMotion& at, double turned, double seconds);
  // The rod may have been turned, and nobody counted it.
  void lose();

  bool known() const { return known_; }  // the angle is from feet straight down
  // Passes that contradicted the angle by more than a quarter turn. They change nothing: the mark,
  // or its switch, is not where it was.
  std::uint64_t disagreements() const { return disagreements_; }

 private:
  void take(const IndexPass& pass);

  std::optional<IndexMark> mark_;
  double most_step_;
  IndexPasses passes_;
  bool known_ = false;
  double left_ = 0;  // [rad] to be added yet
  double rate_ = 0;  // [rad/s] of that
  std::uint64_t disagreements_ = 0;
};

}  // namespace cabinet
