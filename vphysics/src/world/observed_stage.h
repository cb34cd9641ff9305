// Notifies an observer, if there is one, of the begin and the end of a stage.
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
