// Tells an observer, if there is one, when a stage of the step begins and ends.
#pragma once

#include "vphysics/stages.h"

namespace vp {

class InStage {
 public:
  InStage(StageObserver* observer, Stage stage) : observer_(observer), stage_(stage) {
    if (observer_) observer_->begin(stage_);
  }
  ~InStage() {
    if (observer_) observer_->end(stage_);
  }
  InStage(const InStage&) = delete;
  InStage& operator=(const InStage&) = delete;

 private:
  StageObserver* observer_;
  Stage stage_;
};

}  // namespace vp
