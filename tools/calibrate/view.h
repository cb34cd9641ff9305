// The calibration on the screen: what to do, how far it has come, the raw counts as they arrive,
// and what the fit has found.
#pragma once

#include "render/ui_batch.h"
#include "session.h"

namespace calibrate {

// path: where the numbers are kept; problem: why they could not be, or empty.
struct ViewState {
  foosball::Layout layout = foosball::Layout::tournament;
  std::string device{}, path{}, problem{};
};

void draw_session(client::UiBatch& ui, const Session& session, const ViewState& state,
                  const glm::ivec2& screen);

}  // namespace calibrate
