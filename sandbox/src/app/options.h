// The command line of vphysics-sandbox.
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "draw/command_line.h"
#include "draw/quality.h"
#include "view/scene_view.h"

namespace sandbox {

struct Options {
  std::string scene = "towers1120";
  int rate = 1000;     // [Hz]
  double speed = 1.0;  // relative to real time
  bool paused = false, no_window = false, no_panel = false;
  double skip_to = 0.0;                 // scene time; the steps until then are not drawn
  std::optional<double> seconds;        // scene time, then exit
  std::optional<double> screenshot_at;  // scene time; none: at the end
  std::string screenshot, stats_file, font_directory;
  glm::ivec2 size{1280, 720};
  bool fullscreen = false;
  std::optional<draw::Quality> quality;  // none: chosen by the driver
  std::optional<glm::dvec3> look;  // yaw, pitch [rad], fraction of the distance that shows all
  ViewOptions view;
};

tl::expected<Options, draw::Leave> parse_options(int argc, const char* const* argv);
// The scenes with a description, one line each.
std::string scene_list();

}  // namespace sandbox
