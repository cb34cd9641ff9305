// The panel over the picture: statistics and controls, drawn with Dear ImGui.
#pragma once

#include <optional>
#include <string>

#include "app/meter.h"
#include "core/simulation.h"
#include "view/scene_view.h"

namespace sandbox {

// Width from the window's left edge to the panel's end, with its margins [px].
inline constexpr double kPanelReach = 342.0;

// Settings that persist between frames.
struct Controls {
  bool paused = false;
  int rate = 1000;     // [Hz]
  double speed = 1.0;  // relative to real time
  ViewOptions view;
  int thrown = 0;  // index in kThrownNames
  bool panel = true;
};

// Requests of one frame.
struct Requests {
  bool step = false, reset = false, show_all = false, throw_one = false, leave = false;
  std::optional<std::string> scene;
};

// From keys; the panel's input fields take precedence.
void read_keys(const Simulation& simulation, Controls& controls, Requests& requests);

// drawing: duration of the last picture [s]; message: the last error, or empty.
void draw_panel(const Simulation& simulation, const Meter& meter, double drawing,
                const std::string& message, Controls& controls, Requests& requests);

// Sets the panel's colours and font; the error says which package to install.
tl::expected<void, std::string> style_panel(const std::string& font_directory);

}  // namespace sandbox
