// The calibration on the screen: the instructions, the progress, the raw counts as they arrive, and
// the result of the fit.
#pragma once

#include "render/ui_batch.h"
#include "session.h"

namespace calibrate {

// path: where the calibration is stored; problem: why it could not be stored, or empty.
struct ViewState {
  foosball::Layout layout = foosball::Layout::tournament;
  std::string device{}, path{}, problem{};
};

void draw_session(client::UiBatch& ui, const Session& session, const ViewState& state,
                  const glm::ivec2& screen);

}  // namespace calibrate
