// The command line of space-foosball.
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "client/connection.h"
#include "client/settings.h"
#include "draw/command_line.h"
#include "draw/quality.h"

namespace client {

struct Options {
  ConnectionOptions connection;
  glm::ivec2 size{1280, 720};
  bool fullscreen = false;
  std::optional<View> view;  // none: from the settings
  bool mute = false;
  bool show_fps = false;
  // Also use the gamepads that a cabinet's controller emulates. Its server has the rods otherwise.
  bool cabinet_gamepads = false;
  bool until_server_ends = false;        // exit when the server says Bye; otherwise wait for it
  std::optional<draw::Quality> quality;  // none: chosen by what the machine can draw
  std::optional<double> seconds;         // play for this time, then exit
  std::optional<double> screenshot_at;   // none: at the end
  std::string screenshot, stats_file, font_directory;
  // Names of the people at this window; missing ones come from the settings.
  std::vector<std::string> names;
};

tl::expected<Options, draw::Leave> parse_options(int argc, const char* const* argv);

// "HOST:PORT", "HOST" or ":PORT"; the error is a sentence.
tl::expected<void, std::string> parse_server(const std::string& text, ConnectionOptions& into);

}  // namespace client
