// What is written over the picture, and what can be set there: Dear ImGui.
#pragma once

#include <optional>
#include <string>

#include "app/meter.h"
#include "core/simulation.h"
#include "view/scene_view.h"

namespace sandbox {

// From the window's left edge to where the panel ends, with its margins [px].
inline constexpr double kPanelReach = 342.0;

// What stays as it was set.
struct Controls {
  bool paused = false;
  int rate = 1000;     // [Hz]
  double speed = 1.0;  // of real time
  ViewOptions view;
  int thrown = 0;  // of kThrownNames
  bool panel = true;
};

// What was asked for in a frame.
struct Requests {
  bool step = false, reset = false, show_all = false, throw_one = false, leave = false;
  std::optional<std::string> scene;
};

// By key; the panel's own fields have them first.
void read_keys(const Simulation& simulation, Controls& controls, Requests& requests);

// drawing: how long the last picture took [s]; message: of what last went wrong, or empty.
void draw_panel(const Simulation& simulation, const Meter& meter, double drawing,
                const std::string& message, Controls& controls, Requests& requests);

// Colours and the font of what is drawn; the error says which package to install.
tl::expected<void, std::string> style_panel(const std::string& font_directory);

}  // namespace sandbox
